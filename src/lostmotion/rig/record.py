"""rig.record: an experiment on the virtual rig as its sensors show it, and separately the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from ..signals import excitation
from ..simulation import measure, simulate
from ..systems import DiscreteSystem, Stepper
from .equivalent import two_mass_equivalent
from .nominal import COULOMB, INERTIAS, VISCOUS, Rig, nominal_rig, varied_rig

Law = DiscreteSystem | Stepper

#: Signals of the rig's sensors, beside the commanded motor torque.
CHANNELS = ("speed_motor", "speed_load", "torque_shaft", "twist")


@dataclass(frozen=True, eq=False)
class Truth:
    """The truth, which no estimator may use.

    Parameters
    ----------
    parameters : dict
        The equivalent two-mass parameters, see ``two_mass_equivalent``: ``coulomb`` and ``viscous`` are None where they
        do not follow from the load's motion.
    drivetrain : Drivetrain
        The rig's own chain.
    signals : Recording
        The exact signals.
    """

    parameters: dict[str, float | None]
    drivetrain: Drivetrain
    signals: Recording


@checks_arguments
def record(
    rig: int | Rig | None = 1,
    *,
    torque_motor: ArrayLike | None = None,
    torque_load: ArrayLike | None = None,
    law: Law | Sequence[Law] | None = None,
    state: Sequence[float] | Mapping[str, Any] | None = None,
    dt: float = 1e-4,
    delay: int | Sequence[int] = 1,
    noise_seed: int = 0,
    channels: Sequence[str] = CHANNELS,
    **signals: ArrayLike | None,
) -> tuple[Recording, Truth]:
    """Record an experiment on the virtual rig.

    Parameters
    ----------
    rig : int, Rig or None
        Seed of a rig of the family, or a rig; None: the nominal one.
    torque_motor : (n,) array, Nm, optional
        Set-point of the motor torque. Default without a law: 10 s of ``signals.excitation``.
    torque_load : (n,) array, Nm, optional
        Torque on the load, positive in the direction of positive speed; no sensor shows it.
    law : DiscreteSystem, Stepper, or sequence of them, optional
        Laws in the loop; they read the rig's sensors, ``signals`` and each other's outputs, see ``simulate``.
    state : sequence or mapping, optional
        Start, see ``simulate``; default: at rest in the middle of the gap.
    dt : float, s
        Sample time of drive and recording.
    delay : int, or sequence of int for each law
        Samples of computing delay (default 1, as drives have it).
    noise_seed : int
        Varies the sensors' noise, not the rig.
    channels : sequence of str
        Out of ``CHANNELS``; the commanded ``torque_motor`` is always recorded.
    **signals : (n,) arrays
        Set-points of the laws, such as ``speed_reference`` (rad/s); recorded.

    Returns
    -------
    (Recording, Truth)
        The recording contains the sensors' signals, of origin "simulated": ``torque_motor`` is the set-point (the
        torque itself follows with a lag), speeds are count differences over the last sample.

    Raises
    ------
    InvalidInput
        For unknown channels; otherwise as ``simulate``.
    """
    if not isinstance(rig, Rig):
        rig = nominal_rig() if rig is None else varied_rig(rig)
    seed = rig.seed
    unknown = sorted(set(channels) - set(rig.sensors))
    if unknown:
        raise InvalidInput(
            "rig.record: channels", f"{unknown}", f"names out of {CHANNELS}", "Check the names."
        )
    sensor_seed = 1000 * noise_seed + (0 if seed is None else seed)
    references = {name: values for name, values in signals.items() if values is not None}
    given: dict[str, Any] = {"torque_motor": torque_motor, "torque_load": torque_load, **references}
    if law is None and torque_motor is None:
        given["torque_motor"] = _default_excitation(seed, dt)
    loop: dict[str, Any] = {}
    if law is not None:
        laws = (law,) if isinstance(law, Law) else tuple(law)
        read = {name for part in laws for name in part.inputs}
        sensors = {name: sensor for name, sensor in rig.sensors.items() if name in read}
        loop = {"law": law, "delay": delay, "sensors": sensors, "seed": sensor_seed}
    run = simulate(rig.drivetrain, dt=dt, state=state, **loop, **given)
    shown = measure({name: rig.sensors[name] for name in channels}, run.signals, dt, sensor_seed)
    kept = {"torque_motor": run["torque_motor"], **shown, **{name: run[name] for name in references}}
    recording = Recording(
        time=run.time,
        signals=kept,
        origin={name: "reference" if name in references else "simulated" for name in kept},
        meta={
            "source": "virtual rig",
            "rig_seed": seed,
            "noise_seed": noise_seed,
            "speed_from_counts": rig.sensors["speed_motor"].difference,
            "averaged": tuple(name for name in channels if rig.sensors[name].difference),
        },
    )
    return recording, Truth(two_mass_equivalent(rig.drivetrain, run["speed_load"]), rig.drivetrain, run)


def _default_excitation(seed: int | None, dt: float) -> NDArray[np.float64]:
    return excitation(
        dt=dt, seed=0 if seed is None else seed, inertia=sum(INERTIAS), coulomb=COULOMB, viscous=VISCOUS
    )
