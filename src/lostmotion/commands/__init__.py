"""What the commands do beside the main job: each reads files, calls one function, writes JSON and a picture."""
