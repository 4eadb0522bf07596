"""The TOML of the main job: its shape, its values, its template."""
