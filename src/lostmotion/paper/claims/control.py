"""Claims of sections IV and V: PI and pole placement on the rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...drivetrain import Drivetrain
from ...metrics import CrossingMetrics, StepMetrics, crossing_metrics, step_metrics
from ...rig import Rig
from ...systems import DiscreteSystem
from .. import published
from ..claim import Claim, judged, signed
from ..experiments import Experiments, Run, pi_law, placed_law, speed_step, without_torque_limit

#: Overshoot that can be seen in a figure, and how much less pole placement must have, as a share of PI's (option).
SEEN, MUCH_LESS = 5.0, 0.25
#: Load and oscillation are "higher" from this factor on (option).
HIGHER = 1.2
#: The load speed is smooth if it travels at most this share of the step too far, and the motor at least so many times
#: as far too far (option).
SMOOTH, TIMES = 0.05, 5.0
#: Poles of the sweep, 1/s (option), and how close the fastest within the torque limit must be to the paper's (option).
SWEEP = (-100.0, -200.0, -300.0, -350.0, -400.0, -450.0, -500.0, -600.0)
CLOSE = 0.1  # option
#: Steady error of an accurate law, and of one that is not, as shares of the step (option).
ACCURATE, INACCURATE = 0.005, 0.02
#: Gains of the load speed's PI that are tried, as shares of Table II's (option).
SHARES = (1.0, 0.3, 0.1, 0.03)


@dataclass(frozen=True)
class Response:
    """What the step did to the load, to the motor and to the gap, and how far the two speeds travelled (in steps)."""

    step: StepMetrics
    crossing: CrossingMetrics
    travel_motor: float
    travel_load: float

    @property
    def peak_torque(self) -> float:
        return float(self.step.peak_torque or 0.0)

    @property
    def swing(self) -> float:
        """Largest motor speed − load speed in the 100 ms after the arrival, rad/s."""
        return float("inf") if self.crossing.swing is None else self.crossing.swing


@dataclass(frozen=True)
class Placed:
    """One pole of the sweep: 1/s, time to 90 %, s, and the torque without a limit, Nm."""

    pole: float
    arrival: float
    torque: float


def claims(e: Experiments) -> list[Claim]:
    pi, placed = response(e.pi_step), response(e.placed_step)
    return [
        load_side_pi(load_speed_pi(e.rig), pi.step),
        pi_overshoots(pi),
        less_overshoot(pi, placed),
        more_load(pi, placed),
        more_oscillation(pi, placed),
        smooth_load(placed),
        trade(sweep(e.rig, e.model)),
        needs(
            "V",
            steady_error(e.rig, placed_law(e.model)),
            steady_error(e.rig, placed_law(e.model, prefilter=False)),
        ),
        needs(
            "DC",
            steady_error(e.rig, placed_law(e.model)),
            steady_error(e.rig, placed_law(e.model, compensation=False)),
        ),
    ]


def response(run: Run) -> Response:
    """Of the true signals."""
    s, steps = run.truth.signals, (published.STEP_TIME, published.LOW, published.HIGH)
    after = s.time >= published.STEP_TIME
    size = published.HIGH - published.LOW
    gap = 1 + int(np.argmax([shaft.backlash for shaft in run.truth.drivetrain.shafts]))
    motor, load = (
        float(np.sum(np.abs(np.diff(s[name][after]))) / size) for name in ("speed_motor", "speed_load")
    )
    return Response(
        step_metrics(s.time, s["speed_load"], *steps, s["torque_motor"]),
        crossing_metrics(s.time, s["speed_motor"], s["speed_load"], s.events, *steps, shaft=gap),
        motor,
        load,
    )


def pi_overshoots(pi: Response) -> Claim:
    over = pi.step.overshoot
    return Claim(
        name="PI overshoots",
        says="Even at the optimized parameter setting an overshoot of the speeds can be seen.",
        where="section IV, Fig. 12, Table II",
        quantity="overshoot of the load speed, % of the step",
        value=(over,),
        tolerance=f"at least {SEEN:g} %",
        verdict=judged(over >= SEEN),
        sentence=f"PI overshoots by {over:.1f} % of the step, at a peak torque of {pi.peak_torque:.1f} Nm.",
    )


def beside_pi(pi: float, placed: float, factor: float, *, higher: bool, **said: str) -> Claim:
    """A claim of Fig. 15: under pole placement a number is at least, or at most, so many times that under PI."""
    return Claim(
        where="section V, Fig. 15",
        value=(pi, placed),
        tolerance="pole placement "
        + (f"at least {factor:g} times PI's" if higher else f"at most {factor:g} of PI's"),
        verdict=judged(placed >= factor * pi if higher else placed <= factor * pi),
        **said,
    )


def less_overshoot(pi: Response, placed: Response) -> Claim:
    high, low = pi.step.overshoot, placed.step.overshoot
    return beside_pi(
        high, low, MUCH_LESS, higher=False,
        name="pole placement overshoots much less",
        says="A model based controller can significantly reduce the overshoot.",
        quantity="overshoot of the load speed under PI and pole placement, % of the step",
        sentence=f"{low:.2f} % under Observer 1 and pole placement, {high:.1f} % under PI.",
    )  # fmt: skip


def more_load(pi: Response, placed: Response) -> Claim:
    return beside_pi(
        pi.peak_torque, placed.peak_torque, HIGHER, higher=True,
        name="more actuator load with pole placement",
        says="The controller causes a higher actuator load.",
        quantity="peak torque under PI and pole placement, Nm",
        sentence=f"{placed.peak_torque:.1f} Nm under pole placement, {pi.peak_torque:.1f} Nm under PI; the motor's "
        f"limit is {published.TORQUE_LIMIT:g} Nm.",
    )  # fmt: skip


def more_oscillation(pi: Response, placed: Response) -> Claim:
    return beside_pi(
        pi.swing, placed.swing, HIGHER, higher=True,
        name="more motor oscillation with pole placement",
        says="The controller causes larger oscillations of the speed of the electric motor.",
        quantity="largest motor − load speed in the 100 ms after the arrival, PI and pole placement, rad/s",
        sentence=f"Once the load has arrived the motor swings by {placed.swing:.2f} rad/s against it, under PI "
        f"by {pi.swing:.2f} rad/s. Over the whole step, with the crossing of the gap, its speed travels "
        f"{pi.travel_motor:.1f} steps under PI and {placed.travel_motor:.1f} under pole placement.",
    )  # fmt: skip


def smooth_load(placed: Response) -> Claim:
    load, motor = placed.travel_load - 1.0, placed.travel_motor - 1.0
    return Claim(
        name="the load speed stays smooth",
        says="Nevertheless the speed of the wheel hub remains smooth.",
        where="section V, Fig. 15",
        quantity="how much further than the step load and motor speed travel, % of the step",
        value=(100.0 * load, 100.0 * motor),
        tolerance=f"load at most {100 * SMOOTH:g} %, motor at least {TIMES:g} times as much",
        verdict=judged(load <= SMOOTH, motor >= TIMES * load),
        sentence=f"All ups and downs of the load speed together are {100 * load:.1f} % longer than the step, "
        f"those of the motor speed {100 * motor:.0f} %.",
    )


def load_speed_pi(rig: Rig, shares: Sequence[float] = SHARES) -> dict[float, StepMetrics]:
    """PI on the load's speed, with shares of Table II's gains."""
    found = {}
    for share in shares:
        law = pi_law("speed_load", share * published.PI_KP, share * published.PI_KI)
        found[share] = response(speed_step(rig, law)).step
    return found


def load_side_pi(by_share: Mapping[float, StepMetrics], motor_side: StepMetrics) -> Claim:
    """PI on the speed behind the elastic shaft settles with no gains at all; on the motor speed it does."""
    settled = [share for share, step in by_share.items() if step.settling_time is not None]
    first = next(iter(by_share.values()))
    rest = "With lower gains it rings, or is so slow that it does not settle in 0.5 s either."
    if settled:
        rest = f"With {max(settled):g} of them it settles."
    return Claim(
        name="PI on the load speed fails",
        says="It is not reasonable to feed back the wheel hub's speed with a PI controller: the system is not "
        "collocated.",
        where="section IV",
        quantity=f"overshoot with {', '.join(f'{s:g}' for s in by_share)} of Table II's gains, % of the step",
        value=tuple(step.overshoot for step in by_share.values()),
        tolerance="none settles within 2 % in 0.5 s",
        verdict=judged(*(step.settling_time is None for step in by_share.values())),
        sentence=f"With Table II's gains the load speed swings by {first.overshoot:.0f} % of the step. "
        f"{rest} The same controller on the motor speed settles in "
        f"{motor_side.settling_time or float('nan'):.2f} s.",
    )


def sweep(rig: Rig, model: Drivetrain, poles: Sequence[float] = SWEEP) -> list[Placed]:
    """Time to 90 % and peak torque by the pole, without a torque limit."""
    free = without_torque_limit(rig)
    found = []
    for pole in poles:
        step = response(speed_step(free, placed_law(model, pole=pole, torque_limit=np.inf)))
        found.append(Placed(pole, step.crossing.arrival_time or np.inf, step.peak_torque))
    return found


def fastest_within_limit(rows: Sequence[Placed]) -> float:
    """The pole (1/s) at which the peak torque reaches the motor's limit; NaN outside the sweep."""
    torque, pole = [row.torque for row in rows], [row.pole for row in rows]
    return float(np.interp(published.TORQUE_LIMIT, torque, pole, left=np.nan, right=np.nan))


def trade(rows: Sequence[Placed]) -> Claim:
    """−400 1/s is where speed meets the torque limit."""
    rows = sorted(rows, key=lambda row: -row.pole)
    faster = bool(np.all(np.diff([row.arrival for row in rows]) < 0.0))
    dearer = bool(np.all(np.diff([row.torque for row in rows]) > 0.0))
    best = fastest_within_limit(rows)
    close = abs(best / published.POLE_PLACED - 1.0) <= CLOSE
    return Claim(
        name="−400 1/s is a trade-off",
        says="Poles at −400 1/s are a trade-off between a fast rise and a reasonable load of the motor, of 73.5 Nm "
        "nominal torque.",
        where="section V",
        quantity="pole at which the step takes 73.5 Nm, 1/s",
        value=(best,),
        tolerance=f"within {100 * CLOSE:g} % of −400 1/s; each faster pole is faster and takes more torque",
        verdict=judged(close, faster and dearer),
        sentence=f"The step −2 → 2 rad/s takes {published.TORQUE_LIMIT:g} Nm at {signed(best, '.0f')} 1/s. "
        + "; ".join(
            f"{signed(r.pole, 'g')} 1/s: {1e3 * r.arrival:.0f} ms, {r.torque:.0f} Nm"
            for r in rows
            if r.pole % 200.0 == 0.0
        )
        + ".",
    )


def steady_error(rig: Rig, law: DiscreteSystem) -> float:
    """Of the load speed after the step, as a share of the step."""
    return response(speed_step(rig, law)).step.steady_error


def needs(part: str, complete: float, without: float) -> Claim:
    """Steady-state accuracy with V and DC, and without one of them."""
    what = {"V": "prefilter V", "DC": "friction compensation DC"}[part]
    return Claim(
        name=f"steady-state accuracy needs {part}",
        says="To achieve steady-state accuracy the set-point is multiplied with a static prefilter V."
        if part == "V"
        else "The Coulomb friction is compensated using the filter DC.",
        where="section V, Fig. 14",
        quantity=f"steady error of the load speed with V and DC, and without {part}, % of the step",
        value=(100.0 * complete, 100.0 * without),
        tolerance=f"at most {100 * ACCURATE:g} % with both, at least {100 * INACCURATE:g} % without",
        verdict=judged(complete <= ACCURATE, without >= INACCURATE),
        sentence=f"The load settles {100 * complete:.2f} % of the step beside the set-point with both, "
        f"{100 * without:.1f} % without the {what}.",
    )
