"""The stages of the main job: read, identify, design, validate, export, report; ``run`` calls them in this order."""
