"""The stages of the main job: read, identify, design, validate, export, report; ``run`` puts them in a row."""
