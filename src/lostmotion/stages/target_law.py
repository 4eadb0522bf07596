"""The law for the target, observer + pole placement, and its default poles from the drive."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..controllers import pole_placement, quadratic_poles, soft_landing
from ..controllers.pole_placement import DEFAULT_POLES
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..observers import kalman
from ..observers.fixed_gain.kalman import PROCESS_COVARIANCE
from ..observers.scale import scale_of
from ..systems import (
    DiscreteSystem,
    LoopMargin,
    connect,
    design_model,
    linearised,
    loop_margin,
    one_sample_delay,
)

#: Share of the stiffness that a shaft with backlash shows to a small oscillation (its describing function): closed,
#: half open, at the edges of the gap (numerics: a grid).
GAP_SHARES = (1.0, 0.3, 0.1)
#: Largest sensitivity of the default law (Åström & Hägglund 2006, Advanced PID Control, section 4.6: 1.4 to 2 are
#: usual).
POLES_SENSITIVITY = 1.7
#: Fastest default law: torque that an error of one speed deserves, over what turns the drive to that speed in one
#: radian of the torsional mode (calibrated on Table I with gap and lag × 1 and × 3, ``benchmarks/calibrations.py``:
#: with half of it the slowest pole is at 0.15 of the mode instead of 0.25, with double at 0.34). Then by which factor
#: it becomes slower, and the slowest (numerics).
FASTEST, SLOWER, SLOWEST = 0.4, 0.8, 1e-4
#: Density of the law's load torque on the paper's rig with the paper's poles, Nm²/s (calibrated on Table I, and margins
#: on the development drives 0 to 7 of ``benchmarks/fitted_laws.py``: the largest power of ten with a phase margin above
#: 30° in every contact state of Table I. With 1e6 it was 8° with the load held, where friction and load torque explain
#: the same twist and both are compensated, and 21° in the open gap; a load step was over in 94 instead of 171 ms).
LOAD_TORQUE_COVARIANCE = 1e5
#: Rate of the paper's poles, 1/s, for which the observer's covariances are made.
PAPER_RATE = -DEFAULT_POLES[0]
#: Contact speed of soft landing, as a share of the speed at which all of the torque would cross the gap; how much
#: narrower the gap may be than known, and how fast the limit gives way (calibrated on the virtual rigs 1 to 5: 0.5
#: rad/s there, and the impact of pole placement is not reached where the backlash is known to ±20 % alone).
LANDING_SHARE, TOLERANCE, RELEASE = 0.053, 0.03, 20.0
#: What limits the default poles, in the words of the report.
MODE, DELAY, NOISE = "the torsional mode", "delay and sample time", "noise of the measured speed"


@dataclass(frozen=True)
class Poles:
    """Poles of the state feedback, 1/s, and where they come from: the [law] section, or what limits their speed."""

    values: tuple[complex, ...]
    source: str

    @property
    def rate(self) -> float:
        """Geometric mean of their magnitudes, 1/s: how fast the law is."""
        return math.prod(abs(pole) for pole in self.values) ** (1.0 / len(self.values))

    @property
    def slowest(self) -> float:
        """Decay rate of the slowest one, 1/s."""
        return min(-complex(pole).real for pole in self.values)


def default_poles(
    drivetrain: Drivetrain,
    dt: float,
    speed_from_counts: bool,
    largest_noise_gain: float = math.inf,
    possible: Sequence[Drivetrain] = (),
) -> Poles:
    """The fastest quadratic-optimal poles whose law keeps its margin, and what keeps them from being faster.

    The margin is that of the sampled loop with observer, lag and computing delay, with the gap closed and at its edges.
    ``largest_noise_gain``: standard deviation of the torque over that of the noise on the measured speed, Nm s/rad.
    ``possible``: drives that the law must suit; default: the one that it is designed for.

    Raises
    ------
    InvalidInput
        If even the slowest do not keep it.
    """
    unit = drivetrain.inertia_total * 2.0 * math.pi * drivetrain.pole_frequency
    share, limit = FASTEST, MODE
    while True:
        poles = Poles(quadratic_poles(drivetrain, share * unit), limit)
        margin = law_margin(drivetrain, poles.values, dt, speed_from_counts, possible)
        fast = margin.sensitivity > POLES_SENSITIVITY
        if not fast and margin.torque_per_speed_noise <= largest_noise_gain:
            return poles
        if share < SLOWEST:
            got = f"a sensitivity of {margin.sensitivity:.2g} with the slowest poles"
            expected = f"at most {POLES_SENSITIVITY:g}, and little noise"
            raise InvalidInput(
                "controller pole_placement", got, expected, "Give poles, or a shorter sample time."
            )
        share, limit = SLOWER * share, DELAY if fast else NOISE


def law_margin(
    drivetrain: Drivetrain,
    poles: Sequence[complex],
    dt: float,
    speed_from_counts: bool,
    possible: Sequence[Drivetrain] = (),
) -> LoopMargin:
    """The worst margin of the target's law over ``GAP_SHARES`` on its own drive, or on all those that are possible.

    Unstable where it cannot be designed.
    """
    # Sliding, within the torque limit: what is left of the curves are those of the gap.
    slides = drivetrain.with_parameters(coulomb=0.0, coulomb_motor=0.0, torque_limit=math.inf)
    try:
        law = target_law(slides, poles, math.inf, dt, speed_from_counts, checked=False)
    except InvalidInput:
        return LoopMargin(math.inf, math.inf)
    margins = []
    for plant in possible or (drivetrain,):
        for share in GAP_SHARES if plant.backlash > 0.0 else GAP_SHARES[:1]:
            # Half of the curves are dead zones, with that share of slope one, half what they leave: saturations.
            slopes = [share if curve.slopes[1] == 0.0 else 1.0 - share for curve in law.curves]
            shaft = {"stiffness": share * plant.stiffness, "damping": share * plant.damping}
            model = design_model(plant.with_parameters(**shaft), dt)
            margins.append(loop_margin(linearised(law, slopes), model, speed_from_counts))
    return LoopMargin(
        max(margin.sensitivity for margin in margins),
        max(margin.torque_per_speed_noise for margin in margins),
    )


def target_law(
    drivetrain: Drivetrain,
    poles: Sequence[complex],
    torque_limit: float,
    dt: float,
    speed_from_counts: bool,
    outputs: tuple[str, ...] = ("torque_motor",),
    checked: bool = True,
    landing: bool = False,
) -> DiscreteSystem:
    """Observer + pole placement; the observer's torque is one sample late, as the computing delay makes it act.

    The observer measures the motor speed and estimates the load torque, which the state feedback compensates: that is
    the integral action. Its speed goes with the poles: covariances of the speeds with their square, that of the load
    torque with the fourth power and with the inertia squared. With ``landing``, soft landing limits the torque.
    """
    faster = Poles(tuple(poles), "").rate / PAPER_RATE
    covariance = {name: PROCESS_COVARIANCE[name] * faster**2 for name in ("speed_motor", "speed_load")}
    covariance["torque_load"] = LOAD_TORQUE_COVARIANCE * scale_of(drivetrain).inertia ** 2 * faster**4
    observer = kalman(
        drivetrain,
        dt=dt,
        speed_from_counts=speed_from_counts,
        load_torque=True,
        process_covariance=covariance,
    )
    controllers = [
        pole_placement(drivetrain, poles=poles, dt=dt, torque_limit=torque_limit, load_torque=True)
    ]
    if landing:
        controllers = [
            controllers[0].renamed({"torque_motor": "torque_wished"}), _landing(drivetrain, torque_limit, dt),
        ]  # fmt: skip
    acting = one_sample_delay("torque_motor", dt, "torque_motor_acting")
    return connect(
        [(observer if checked else observer.without_checks()).renamed({"torque_motor": "torque_motor_acting"}),
         *controllers, acting],
        inputs=("speed_reference", "speed_motor"),
        outputs=outputs,
        name="observer_1 + pole_placement" + (" + soft_landing" if landing else ""),
    )  # fmt: skip


def _landing(drivetrain: Drivetrain, torque_limit: float, dt: float) -> DiscreteSystem:
    crossing = math.sqrt(2.0 * torque_limit / drivetrain.inertia_motor * drivetrain.backlash)
    return soft_landing(
        drivetrain,
        dt=dt,
        contact_speed=LANDING_SHARE * crossing,
        torque_limit=torque_limit,
        tolerance=TOLERANCE,
        release=RELEASE,
    )
