"""The cases: what differs from the nominal experiment on the virtual rig; and the drives of the zoo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .zoo_drive import KINDS

#: Parameters that are given wrong to the observers, one at a time.
PARAMETERS = (
    "inertia_motor",
    "inertia_load",
    "stiffness",
    "damping",
    "backlash",
    "coulomb",
    "viscous",
    "lag",
)
#: Group of the cases on drives of the zoo.
ANY_DRIVE = "any drive"


@dataclass(frozen=True)
class Case:
    """One experiment; a field that is left out has its nominal value.

    Parameters
    ----------
    name : str
    group : str
        Cases of one group share a column of the figure.
    quick : bool
        Part of the short comparison.
    drive : str
        "rig": the virtual rig of a seed; or a kind of drive of the zoo, out of ``zoo_drive.KINDS``. On the zoo sample
        time and encoder are the drive's own, and all numbers are in units of the virtual rig, see ``rig.bench``.
    parameters : {"equivalent", "identified"}
        What the observers are built on: the rig's equivalent two-mass parameters, or those identified from a
        recording of their own.
    factors : mapping of parameter → factor
        Applied to the parameters that the observers are given.
    encoder_bits : int
    torque_noise : float, Nm
        Noise of the shaft's torque sensor.
    ripple : float, Nm
        White torque at the motor; not given to the observers.
    dt : float, s
    delay : float, samples
        Delay of the sensors; not given to the observers.
    dropouts : float
        Fraction of the motor sensor's samples that are lost, in bursts.
    load_torque : float, Nm
        Size of a load torque; not given to the observers.
    work : {"reversing", "sticking", "control"}
    wrong_start : bool
        The observer starts on the wrong side of the gap.
    """

    name: str
    group: str
    quick: bool = False
    drive: str = "rig"
    parameters: str = "equivalent"
    factors: Mapping[str, float] = field(default_factory=dict)
    encoder_bits: int = 20
    torque_noise: float = 0.3
    ripple: float = 0.0
    dt: float = 1e-4
    delay: float = 0.0
    dropouts: float = 0.0
    load_torque: float = 0.0
    work: str = "reversing"
    wrong_start: bool = False


def _off(parameter: str, factor: float) -> Case:
    quick = (parameter, factor) in (("inertia_load", 1.2), ("backlash", 1.2))
    percent = f"{100.0 * (factor - 1.0):+.0f} %".replace("-", "−")
    return Case(
        f"{parameter} {percent}", "one parameter off by 20 %", quick=quick, factors={parameter: factor}
    )


CASES: tuple[Case, ...] = (
    Case("nominal", "nominal", quick=True),
    Case("identified", "identified", parameters="identified"),
    *(_off(parameter, factor) for parameter in PARAMETERS for factor in (0.8, 1.2)),
    *(
        Case(f"encoder {b} bit", "encoder 10 to 18 bit", quick=b == 12, encoder_bits=b)
        for b in (10, 12, 14, 16, 18)
    ),
    *(Case(f"torque sensor {n:g} Nm", "torque noise", torque_noise=n) for n in (0.1, 1.0, 3.0)),
    Case("motor torque ripple 1 Nm", "torque noise", ripple=1.0),
    *(
        Case(f"sample time {1e3 * dt:g} ms", "sample time 0.05 to 2 ms", quick=dt == 1e-3, dt=dt)
        for dt in (5e-5, 2e-4, 5e-4, 1e-3, 2e-3)
    ),
    Case("delay 0.4 samples", "sensor delay", delay=0.4),
    Case("delay 1 sample", "sensor delay", delay=1.0),
    Case("drop-outs 2 %", "drop-outs", quick=True, dropouts=0.02),
    Case("load torque 3 Nm", "unknown load torque", quick=True, load_torque=3.0),
    Case("sticking", "sticking", quick=True, work="sticking"),
    Case("wrong start", "wrong start", quick=True, wrong_start=True),
    Case("under control", "under control", quick=True, work="control"),
    *(Case(f"{ANY_DRIVE}, {kind}", ANY_DRIVE, quick=kind == "3 to 5 masses", drive=kind) for kind in KINDS),
)
