"""Parameters from motor torque and speed: the prediction errors of an observer, minimised."""
