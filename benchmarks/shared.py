"""What several benchmarks share: the paper's drivetrain, the parser of the command line, files of results."""

from __future__ import annotations

import argparse
import gzip
import json
from pathlib import Path
from typing import Any

#: Table I of Fietzek & Rinderknecht: the arguments of ``Drivetrain.two_mass``, SI.
TABLE_I = {
    "inertia_motor": 0.0182, "inertia_load": 0.111, "stiffness": 6285.896, "damping": 0.397, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175,
}  # fmt: skip


def parser_of(text: str) -> argparse.ArgumentParser:
    """A parser whose help is the benchmark's docstring, line breaks kept."""
    return argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)


def read(results: Path) -> list[dict[str, Any]]:
    """What the lines of a results file hold, packed (``.gz``) or not; none where there is no file yet."""
    if not results.exists():
        return []
    packed = results.read_bytes()
    lines = gzip.decompress(packed) if results.suffix == ".gz" else packed
    return [json.loads(line) for line in lines.splitlines()]
