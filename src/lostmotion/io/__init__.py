"""Files ↔ Recording, TOML and JSON: the only place that knows units, file formats and pydantic."""
