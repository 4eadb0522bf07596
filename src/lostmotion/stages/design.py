"""Stage 3, design: Observer 1 and 2, the PI speed controller, and the law for the target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..controllers import pi, pole_placement
from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..observers import kalman
from ..observers.estimates import ESTIMATES
from ..recording import Recording
from ..systems import DiscreteSystem, connect, one_sample_delay
from .material import Material, Settings
from .parameters import Found

#: Signals that each observer measures (Fietzek & Rinderknecht, section III).
OBSERVERS = {"observer_1": ("speed_motor",), "observer_2": ("torque_shaft", "speed_motor")}


@dataclass(frozen=True, eq=False)
class Design:
    """The laws, or the reason why there is none.

    Parameters
    ----------
    law : DiscreteSystem or None
        Observer 1 + pole placement, for the target: speed_reference, speed_motor → torque_motor.
    watched : DiscreteSystem or None
        The same law with its estimates as further outputs.
    pi : DiscreteSystem or None
    dt : float, s
    skipped, pi_skipped : str
    problems : tuple of Problem
    """

    law: DiscreteSystem | None = None
    watched: DiscreteSystem | None = None
    pi: DiscreteSystem | None = None
    dt: float = 0.0
    skipped: str = ""
    pi_skipped: str = ""
    problems: tuple[Problem, ...] = ()


def design(material: Material, found: Found) -> Design:
    """The laws for an identified drivetrain; a law that cannot be designed is a result, not an exception."""
    drivetrain, settings = found.drivetrain, material.settings
    if drivetrain is None:
        return Design(skipped=found.missing, pi_skipped=found.missing)
    recording = material.identify or material.validate
    dt = settings.sample_time or (recording.dt if recording is not None else None)
    if dt is None:
        reason = "no sample time: give sample_time in [law]"
        return Design(skipped=reason, pi_skipped=reason)
    averaged = is_averaged(recording, found)

    def target(outputs: tuple[str, ...]) -> DiscreteSystem:
        return target_law(drivetrain, settings, dt, averaged, outputs)

    law, law_problem = _tried(lambda: target(("torque_motor",)))
    watched, _ = _tried(lambda: target(("torque_motor", *ESTIMATES)))
    controller, pi_problem = _tried(
        lambda: pi(dt=dt, kp=settings.kp, ki=settings.ki, torque_limit=settings.torque_limit)
    )
    return Design(
        law=law,
        watched=watched,
        pi=controller,
        dt=dt,
        skipped=str(law_problem or ""),
        pi_skipped=str(pi_problem or ""),
        problems=tuple(p for p in (law_problem, pi_problem) if p is not None),
    )


def _tried(make: Callable[[], DiscreteSystem]) -> tuple[DiscreteSystem | None, Problem | None]:
    """A law, or a warning why it cannot be designed."""
    try:
        return make(), None
    except InvalidInput as error:
        return None, replace(error.problem, severity="warning")


def is_averaged(recording: Recording | None, found: Found) -> bool:
    """Whether a recording's motor speed is a mean over the sample: as stated in it, else as identification found."""
    seen = found.identification is not None and found.identification.speed_from_counts
    return seen if recording is None else bool(recording.meta.get("speed_from_counts", seen))


def observer(drivetrain: Drivetrain, name: str, dt: float, averaged: bool) -> DiscreteSystem:
    """Observer 1 or 2 for a recording at the sample time dt (s)."""
    return kalman(drivetrain, measured=OBSERVERS[name], dt=dt, speed_from_counts=averaged)


def target_law(
    drivetrain: Drivetrain, settings: Settings, dt: float, averaged: bool, outputs: tuple[str, ...]
) -> DiscreteSystem:
    """Observer 1 + pole placement; the observer's torque is one sample late, as the computing delay makes it act."""
    watcher = observer(drivetrain, "observer_1", dt, averaged).renamed(
        {"torque_motor": "torque_motor_acting"}
    )
    controller = pole_placement(drivetrain, poles=settings.poles, dt=dt, torque_limit=settings.torque_limit)
    acting = one_sample_delay("torque_motor", dt, "torque_motor_acting")
    return connect(
        [watcher, controller, acting],
        inputs=("speed_reference", "speed_motor"),
        outputs=outputs,
        name="observer_1 + pole_placement",
    )
