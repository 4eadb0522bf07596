"""Files ↔ Recording, TOML and JSON: the only place that knows units, file formats and pydantic.

The public names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .configuration.problems import find_problems
    from .configuration.read import (
        Configuration,
        RecordingSource,
        load_recordings,
        read_configuration,
        template,
    )
    from .configuration.schema import configuration_schema
    from .recordings.alignment import aligned
    from .recordings.checks import check_recording
    from .recordings.read import READERS, read_recording
    from .storage.drivetrain_files import load_drivetrain, save_drivetrain
    from .storage.folders import foreign_files, output_folder
    from .storage.json_files import load_json, save_json
    from .storage.law_files import load_law, save_law
    from .storage.recording_files import load_recording, save_recording
    from .tables.channels import Channel
    from .tables.columns import Column
    from .tables.csv_writing import write_csv
    from .tables.matrices import read_torsional_model
    from .tables.units import parse_quantity

_HOME = {
    "READERS": "recordings.read",
    "Channel": "tables.channels",
    "Column": "tables.columns",
    "Configuration": "configuration.read",
    "RecordingSource": "configuration.read",
    "aligned": "recordings.alignment",
    "check_recording": "recordings.checks",
    "configuration_schema": "configuration.schema",
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
    "read_torsional_model": "tables.matrices",
    "save_drivetrain": "storage.drivetrain_files",
    "save_json": "storage.json_files",
    "save_law": "storage.law_files",
    "save_recording": "storage.recording_files",
    "template": "configuration.read",
    "write_csv": "tables.csv_writing",
}

__all__ = [
    "READERS",
    "Channel",
    "Column",
    "Configuration",
    "RecordingSource",
    "aligned",
    "check_recording",
    "configuration_schema",
    "find_problems",
    "foreign_files",
    "load_drivetrain",
    "load_json",
    "load_law",
    "load_recording",
    "load_recordings",
    "output_folder",
    "parse_quantity",
    "read_configuration",
    "read_recording",
    "read_torsional_model",
    "save_drivetrain",
    "save_json",
    "save_law",
    "save_recording",
    "template",
    "write_csv",
]


if not TYPE_CHECKING:  # a type checker sees the imports above, and that nothing else is here

    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
