"""The drive of the zoo that a seed of a comparison meets."""

from __future__ import annotations

import functools
from collections.abc import Callable

from .. import rig
from ..errors import InvalidInput

#: A gap is wide from this multiple of the wind-up at the torque limit on (option: then stiffness·backlash is more than
#: twenty times the noise torque of the observers' experiment, see docs/choosing-an-observer.md).
WIDE = 2.0


def has_wide_gap(bench: rig.Bench) -> bool:
    return bench.model.stiffness * bench.model.backlash > WIDE * rig.TORQUE_LIMIT


def has_two_masses(bench: rig.Bench) -> bool:
    """Two masses and no wide gap."""
    return len(bench.rig.drivetrain.inertias) == 2 and not has_wide_gap(bench)


def has_further_masses(bench: rig.Bench) -> bool:
    """Three to five masses and no wide gap."""
    return len(bench.rig.drivetrain.inertias) > 2 and not has_wide_gap(bench)


#: Every drive is of one kind.
KINDS = {"two masses": has_two_masses, "3 to 5 masses": has_further_masses, "wide gap": has_wide_gap}


@functools.lru_cache(maxsize=64)
def zoo_drive(seed: int, apart: int, suits: Callable[[rig.Bench], bool] = lambda bench: True) -> rig.Bench:
    """The first suitable drive with one gap and little delay, out of the ``apart`` test drives of this seed's own.

    Two seeds have no drive in common if they differ by less than 10 000 / apart - 1.

    Raises
    ------
    InvalidInput
        If none of them suits.
    """
    drives = rig.SETS["test"]
    own = (drives[(apart * seed + further) % len(drives)] for further in range(apart))
    for bench in map(rig.bench, own):
        if bench is not None and suits(bench):
            return bench
    raise InvalidInput(
        "zoo_drive.seed", f"{seed}, none of whose {apart} drives suits", "one with one gap, little delay, of that kind",
        "Take another seed.",
    )  # fmt: skip
