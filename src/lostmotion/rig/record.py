"""rig.record: an experiment on the virtual rig as its sensors show it, and separately the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from ..signals import excitation
from ..simulation import measure, simulate
from ..systems import DiscreteSystem
from .equivalent import two_mass_equivalent
from .nominal import COULOMB, INERTIAS, VISCOUS, Rig, nominal_rig, varied_rig

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
    law: DiscreteSystem | None = None,
    speed_reference: ArrayLike | None = None,
    dt: float = 1e-4,
    delay: int = 1,
    noise_seed: int = 0,
    channels: Sequence[str] = CHANNELS,
) -> tuple[Recording, Truth]:
    """Record an experiment on the virtual rig.

    Parameters
    ----------
    rig : int, Rig or None
        Seed of a rig of the family, or a rig; None: the nominal one.
    torque_motor : (n,) array, Nm, optional
        Set-point of the motor torque. Default without a law: 10 s of ``signals.excitation``.
    law : DiscreteSystem, optional
        A law in the loop; it reads the rig's sensors and ``speed_reference``.
    speed_reference : (n,) array, rad/s, optional
        Set-point for the law.
    dt : float, s
        Sample time of drive and recording.
    delay : {0, 1}
        Samples of computing delay of the law (default 1, as drives have it).
    noise_seed : int
        Varies the sensors' noise, not the rig.
    channels : sequence of str
        Out of ``CHANNELS``; the commanded ``torque_motor`` is always recorded.

    Returns
    -------
    (Recording, Truth)
        The recording contains the sensors' signals, of origin "simulated": ``torque_motor`` is the set-point (the
        torque itself follows with a lag), speeds are count differences over the last sample.
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
    signals = _run(rig, torque_motor, law, speed_reference, dt, delay, sensor_seed, seed)
    shown = measure({name: rig.sensors[name] for name in channels}, signals.signals, dt, sensor_seed)
    kept = {"torque_motor": signals["torque_motor"], **shown}
    if "speed_reference" in signals:
        kept["speed_reference"] = signals["speed_reference"]
    recording = Recording(
        time=signals.time,
        signals=kept,
        origin={name: "reference" if name == "speed_reference" else "simulated" for name in kept},
        meta={
            "source": "virtual rig",
            "rig_seed": seed,
            "noise_seed": noise_seed,
            "speed_from_counts": rig.sensors["speed_motor"].difference,
            "averaged": tuple(name for name in channels if rig.sensors[name].difference),
        },
    )
    return recording, Truth(
        two_mass_equivalent(rig.drivetrain, signals["speed_load"]), rig.drivetrain, signals
    )


def _run(
    rig: Rig,
    torque_motor: ArrayLike | None,
    law: DiscreteSystem | None,
    speed_reference: ArrayLike | None,
    dt: float,
    delay: int,
    sensor_seed: int,
    seed: int | None,
) -> Recording:
    if law is None:
        if torque_motor is None:
            torque_motor = excitation(
                dt=dt,
                seed=0 if seed is None else seed,
                inertia=sum(INERTIAS),
                coulomb=COULOMB,
                viscous=VISCOUS,
            )
        return simulate(rig.drivetrain, dt=dt, torque_motor=torque_motor)
    sensors = {name: sensor for name, sensor in rig.sensors.items() if name in law.inputs}
    given: dict[str, Any] = {} if speed_reference is None else {"speed_reference": speed_reference}
    return simulate(
        rig.drivetrain,
        dt=dt,
        torque_motor=torque_motor,
        law=law,
        delay=delay,
        sensors=sensors,
        seed=sensor_seed,
        **given,
    )
