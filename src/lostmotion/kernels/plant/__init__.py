"""One drivetrain, exactly: its contact states, their closed-form solutions, and the way from event to event."""
