"""Files ↔ Recording, TOML and JSON: the only place that knows units, file formats and pydantic.

The public names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOME = {
    "Channel": "tables.channels",
    "Configuration": "configuration.read",
    "RecordingSource": "configuration.read",
    "check_recording": "recordings.checks",
    "find_problems": "configuration.problems",
    "foreign_files": "storage.folders",
    "load_drivetrain": "storage.drivetrain_files",
    "load_json": "storage.json_files",
    "load_law": "storage.law_files",
    "load_recording": "storage.recording_files",
    "load_recordings": "configuration.read",
    "output_folder": "storage.folders",
    "parse_quantity": "tables.units",
    "read_configuration": "configuration.read",
    "read_recording": "recordings.read",
    "save_drivetrain": "storage.drivetrain_files",
    "save_json": "storage.json_files",
    "save_law": "storage.law_files",
    "save_recording": "storage.recording_files",
    "template": "configuration.read",
    "write_csv": "tables.csv_writing",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
