"""The cases: what the drive is asked to do, and what differs from the nominal virtual rig."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..cases import PARAMETERS

#: The drive: the virtual rig of a seed, or a drive of the zoo (``compare.zoo_drive``).
DRIVES = ("rig", "zoo")
#: What the drive is asked to do, see ``work``.
WORKS = ("step", "pulse", "load step", "creep", "rest", "tip-in", "tip-out")


@dataclass(frozen=True)
class Case:
    """One experiment; a field that is left out has its nominal value.

    Parameters
    ----------
    name, group, quick
        As in ``compare.cases.Case``.
    work : str
        Out of ``WORKS``. In tip-in and tip-out a torque is asked for, in the others a speed of the load.
    drive : str
        Out of ``DRIVES``. On the zoo the laws are given the drive's equivalent parameters, sample time, encoder and
        delay are its own, and all numbers are in units of the virtual rig, see ``rig.bench``.
    true_states : bool
        The laws read the true states instead of an observer's.
    factors : mapping of parameter → factor
        Applied to the parameters that laws and observers are given.
    load_inertia, backlash : float
        Factor on the rig's own, not given to the laws.
    dt : float, s
    encoder_bits : int
    dropouts : float
        Fraction of lost samples of the motor sensor.
    """

    name: str
    group: str
    quick: bool = False
    work: str = "step"
    drive: str = "rig"
    true_states: bool = False
    factors: Mapping[str, float] = field(default_factory=dict)
    load_inertia: float = 1.0
    backlash: float = 1.0
    dt: float = 1e-4
    encoder_bits: int = 20
    dropouts: float = 0.0


def _percent(factor: float) -> str:
    return f"{100.0 * (factor - 1.0):+.0f} %".replace("-", "−")


CASES: tuple[Case, ...] = (
    Case("step", "step", quick=True),
    Case("true states", "true states", true_states=True),
    Case("pulse", "pulse", work="pulse"),
    Case("load step", "load step", quick=True, work="load step"),
    Case("creep", "creep", work="creep"),
    *(
        Case(f"rest, friction model × {f:g}", "rest", quick=f == 1.5, work="rest", factors={"coulomb": f})
        for f in (0.8, 1.0, 1.5)
    ),
    Case("tip-in", "tip-in and tip-out", quick=True, work="tip-in"),
    Case("tip-out", "tip-in and tip-out", work="tip-out"),
    *(
        Case(f"true states, {work}", "true states", work=work, true_states=True)
        for work in WORKS
        if work != "step"
    ),
    *(
        Case(f"{p} {_percent(f)}", "one parameter off by 20 %", factors={p: f})
        for p in PARAMETERS
        if p != "backlash"
        for f in (0.8, 1.2)
    ),
    *(
        Case(f"known backlash {_percent(f)}", "known backlash ±20 %", quick=f == 1.2, factors={"backlash": f})
        for f in (0.8, 1.2)
    ),
    *(
        Case(f"load inertia × {f:g}", "load inertia × 0.5 to 3", quick=f == 3.0, load_inertia=f)
        for f in (0.5, 2.0, 3.0)
    ),
    *(
        Case(f"backlash × {f:g}", "backlash × 0 to 3", backlash=f, factors={"backlash": f})
        for f in (0.0, 0.5, 2.0, 3.0)
    ),
    *(
        Case(f"sample time {1e3 * dt:g} ms", "sample time 0.2 to 2 ms", dt=dt)
        for dt in (2e-4, 5e-4, 1e-3, 2e-3)
    ),
    *(
        Case(f"encoder {b} bit", "encoder 10 to 18 bit", quick=b == 14, encoder_bits=b)
        for b in (10, 12, 14, 16, 18)
    ),
    Case("drop-outs 2 %", "drop-outs", dropouts=0.02),
    *(
        Case(f"zoo, {work}", "drives of the zoo", quick=work == "step", work=work, drive="zoo")
        for work in ("step", "load step", "rest", "tip-in")
    ),
    *(
        Case(
            f"zoo, known backlash {_percent(f)}",
            "zoo, known backlash ±20 %",
            drive="zoo",
            factors={"backlash": f},
        )
        for f in (0.8, 1.2)
    ),
)
