"""What several benchmarks share: the paper's drivetrain and the parser of the command line."""

from __future__ import annotations

import argparse

#: Table I of Fietzek & Rinderknecht: the arguments of ``Drivetrain.two_mass``, SI.
TABLE_I = {
    "inertia_motor": 0.0182, "inertia_load": 0.111, "stiffness": 6285.896, "damping": 0.397, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175,
}  # fmt: skip


def parser_of(text: str) -> argparse.ArgumentParser:
    """A parser whose help is the benchmark's docstring, line breaks kept."""
    return argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
