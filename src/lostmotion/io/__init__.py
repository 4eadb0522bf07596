"""Files ↔ Recording, TOML and JSON: the only place that knows units, file formats and pydantic.

The public names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOME = {
    "Channel": "channels",
    "Configuration": "configuration",
    "RecordingSource": "configuration",
    "check_recording": "checks",
    "foreign_files": "folders",
    "load_drivetrain": "drivetrain_files",
    "load_json": "storage",
    "load_law": "storage",
    "load_recording": "storage",
    "load_recordings": "configuration",
    "output_folder": "folders",
    "parse_quantity": "units",
    "read_configuration": "configuration",
    "read_recording": "recordings",
    "save_drivetrain": "drivetrain_files",
    "save_json": "storage",
    "save_law": "storage",
    "save_recording": "storage",
    "template": "configuration",
    "write_csv": "csv_writing",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
