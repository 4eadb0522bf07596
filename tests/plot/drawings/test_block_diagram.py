"""Block diagrams over the whole family of laws and observers: all there once, nothing overlaps or is cut off."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from all_steppers import STEPPERS
from drawn import crossed, curve_lines, cut_off, overlapping, texts
from matplotlib.figure import Figure
from table_i import PAPER

from lostmotion import connect, controllers, plot
from lostmotion.curves import PiecewiseLinear, dead_zone, saturation
from lostmotion.errors import InvalidInput
from lostmotion.observers import disturbance_observer, kalman, shaft_torque
from lostmotion.observers import h_infinity as h_infinity_observer
from lostmotion.plot.drawings.curve_icons import grouped, kind
from lostmotion.systems import DiscreteSystem, Stepper, minimum, one_sample_delay, rate_limit

LAGGED = PAPER.with_parameters(lag=3e-4)
WISHES = {"dt": 1e-4, "largest_error": 2.0, "largest_torque": 73.5}
OBSERVER_1 = kalman(PAPER, dt=1e-4)
PLACED = controllers.pole_placement(PAPER, dt=1e-4, torque_limit=73.5)
LAWS = {
    "Observer 1": OBSERVER_1,
    "Observer 2": kalman(PAPER, measured=("torque_shaft", "speed_motor"), dt=1e-4),
    "kalman, scheduled": kalman(
        PAPER, measured=("torque_shaft", "speed_motor"), dt=1e-4, contact_scheduling=True, load_torque=True
    ),
    "kalman, linear": kalman(PAPER.with_parameters(backlash=0.0, coulomb=0.0), dt=1e-4),
    "H infinity observer": h_infinity_observer(LAGGED, dt=1e-4, speed_from_counts=True),
    "shaft torque": shaft_torque(6285.896, dt=1e-3, torque_delay=4e-4),
    "disturbance observer": disturbance_observer(LAGGED, dt=1e-4, speed_from_counts=True),
    "pi": controllers.pi(dt=1e-4),
    "pi with anti-windup": controllers.pi(dt=1e-4, torque_limit=20.0),
    "pi with all": controllers.pi(dt=1e-4, torque_limit=20.0, filter_time=0.02, friction_of=PAPER),
    "pole placement": controllers.pole_placement(PAPER, dt=1e-4),
    "pole placement with limit": PLACED,
    "pole placement, by reference": controllers.pole_placement(
        PAPER.with_parameters(coulomb_motor=0.3), dt=1e-4, torque_limit=73.5, friction_compensation="reference"
    ),
    "lqi": controllers.lqi(LAGGED, **WISHES, torque_limit=73.5),
    "flatness": controllers.flatness(PAPER, **WISHES, largest_acceleration=300.0, largest_jerk=1e5),
    "H infinity": controllers.h_infinity(LAGGED, **WISHES, load_torque=10.0, torque_limit=73.5),
    "predictive": controllers.predictive(LAGGED, **WISHES, torque_limit=73.5),
    "notch": controllers.notch("torque_wished", "torque_motor", frequency=100.0, dt=1e-4),
    "sliding mode": controllers.sliding_mode(PAPER, dt=1e-4, switching_torque=40.0, torque_limit=73.5),
    "super-twisting": controllers.super_twisting(
        PAPER, dt=1e-4, switching_torque=20.0, torque_limit=73.5, integral_rate=200.0
    ),
    "speed course": controllers.speed_course(largest_acceleration=300.0, largest_jerk=1e5, dt=1e-4),
    "active damping": controllers.active_damping(PAPER, dt=1e-4, torque_limit=73.5),
    "soft landing": controllers.soft_landing(PAPER, dt=1e-4, contact_speed=0.6, torque_limit=73.5),
    "minimum": minimum("a", "b", "c", 1e-4),
    "rate limit": rate_limit("a", "b", rate=1e4, dt=1e-4),
    "delay": one_sample_delay("torque_motor", 1e-4, start=0.5),
    "observer 1 + pole placement": connect(
        [OBSERVER_1, PLACED], inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",)
    ),
}  # fmt: skip
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
MATRICES = "ABCDEFGHJ"


def assert_readable(figure: Figure) -> None:
    assert overlapping(figure) == []
    assert cut_off(figure) == []
    assert crossed(figure) == []


def named(figure: Figure, signal: str) -> int:
    """How often a signal stands on the drawing, with or without its unit."""
    return sum(text == signal or text.startswith(f"{signal} (") for text in texts(figure))


def captioned(figure: Figure) -> list[str]:
    """What each curve is called, in their order; equal neighbours share a caption."""
    found: dict[int, str] = {}
    for text in texts(figure):
        if match := re.fullmatch(r"w(\d+)(?:(?: …|,) w(\d+))? (.+)", text):
            first, last = int(match[1]), int(match[2] or match[1])
            assert not found.keys() & set(range(first, last + 1))
            found |= dict.fromkeys(range(first, last + 1), match[3])
    assert sorted(found) == list(range(1, len(found) + 1))
    return [found[number] for number in sorted(found)]


def set_apart(curves: Sequence[PiecewiseLinear]) -> list[PiecewiseLinear]:
    """The curves without those that equal the one before."""
    return [curve for i, curve in enumerate(curves) if i == 0 or curve != curves[i - 1]]


@every_law
def test_a_law_is_readable_and_shows_all_that_it_has_once(law: DiscreteSystem) -> None:
    figure = plot.block_diagram(law)
    assert_readable(figure)
    signals = [*law.inputs, *law.outputs, *law.states]
    for signal in set(signals):
        assert named(figure, signal) == signals.count(signal), signal
    assert captioned(figure) == [kind(curve)[0] for curve in law.curves]
    assert len(curve_lines(figure)) == len(grouped(law.curves)) == len(set_apart(law.curves))
    assert texts(figure).count("check") == len(law.checks)


@every_law
def test_of_the_matrices_those_with_a_number_are_drawn_once_each(law: DiscreteSystem) -> None:
    """Identities are lines; a single sum of inputs has its gains on the arrows instead of G or D."""
    shown = texts(plot.block_diagram(law))
    drawn = [name for name in MATRICES if name in shown]
    assert all(shown.count(name) == 1 for name in drawn)
    there = [name for name in MATRICES if np.any(getattr(law, name))]
    if law.states:
        assert [name for name in there if name != "J"] == [name for name in drawn if name != "J"]
    assert set(drawn) <= set(there)
    sizes = [f"{m.shape[0]}×{m.shape[1]}" for m in (getattr(law, n) for n in drawn) if m.size > 1]
    assert sorted(text for text in shown if "×" in text) == sorted(sizes)


def test_a_static_sum_has_its_gains_on_the_arrows() -> None:
    shown = texts(plot.block_diagram(PLACED))
    for gain in PLACED.G[0]:
        assert f"{gain:.3g}".replace("-", "−") in shown


@pytest.mark.parametrize("make", STEPPERS, ids=[s.__name__ for s in STEPPERS])
def test_a_stepper_is_a_block_with_its_ports(make) -> None:
    stepper: Stepper = make(PAPER, dt=1e-4)
    figure = plot.block_diagram(stepper)
    assert_readable(figure)
    for signal in (*stepper.inputs, *stepper.outputs):
        assert named(figure, signal) == 1


def soft_landing_parts() -> list[DiscreteSystem]:
    observer = kalman(LAGGED, dt=1e-4, load_torque=True, speed_from_counts=True)
    speed = LAWS["lqi"].renamed({"torque_motor": "torque_wished"})
    limiter = controllers.soft_landing(LAGGED, dt=1e-4, contact_speed=0.6, torque_limit=73.5)
    return [observer.renamed({"torque_motor": "torque_motor_acting"}), speed, limiter]


JOINED = {
    "pole placement in its loop": ([OBSERVER_1, PLACED], PAPER),
    "observer watching": ([OBSERVER_1, LAWS["pi with anti-windup"]], PAPER),
    "pi alone": ([LAWS["pi with anti-windup"]], PAPER),
    "soft landing": (soft_landing_parts(), LAGGED),
    "no plant": ([OBSERVER_1, PLACED], None),
}


@pytest.mark.parametrize(("laws", "plant"), JOINED.values(), ids=JOINED.keys())
def test_joined_laws_are_readable_and_show_each_link_and_curve_once(laws, plant) -> None:
    figure = plot.block_diagram(laws, plant=plant)
    assert_readable(figure)
    for law in laws:
        assert texts(figure).count(law.name.replace("_", " ")) >= 1
        made = {signal for other in laws for signal in other.outputs}
        for signal in {*law.inputs, *law.outputs}:
            readers = sum(signal in other.inputs for other in laws)
            to_plant = plant is not None and signal == "torque_motor" and signal in made
            assert named(figure, signal) == max(1, readers + to_plant), signal
    assert len(curve_lines(figure)) == sum(len(set_apart(law.curves)) for law in laws)
    assert ("plant" in texts(figure)) == (plant is not None)


def test_the_loop_is_drawn_from_the_controller_over_the_plant_to_the_observer() -> None:
    axes = plot.block_diagram([OBSERVER_1, PLACED], plant=PAPER).axes[0]
    places = {
        text.get_text(): text.get_position()[0] for text in axes.texts if text.get_fontweight() == "bold"
    }
    assert places["pole placement"] < places["plant"] < places["kalman"]


def test_in_a_loop_too_the_gains_of_a_single_sum_are_told() -> None:
    """The prefilter, the gains of the feedback and that of the friction's compensation."""
    shown = texts(plot.block_diagram([OBSERVER_1, PLACED], plant=PAPER))
    for signal, gain in zip(PLACED.inputs, PLACED.G[0], strict=True):
        value = f"{gain:.3g}".replace("-", "−")
        assert sum(text.startswith(f"{signal} (") and text.endswith(f") × {value}") for text in shown) == 1


def test_outputs_that_leave_are_those_that_were_asked_for() -> None:
    figure = plot.block_diagram([OBSERVER_1, PLACED], outputs=["torque_motor"])
    assert named(figure, "twist_estimated") == 0
    assert named(figure, "torque_motor") == 2  # to the observer and out
    with pytest.raises(InvalidInput, match="torque"):
        plot.block_diagram([OBSERVER_1, PLACED], outputs=["torque"])
    with pytest.raises(InvalidInput, match="one maker"):
        plot.block_diagram([PLACED, PLACED])
    with pytest.raises(InvalidInput, match="no law"):
        plot.block_diagram([])


@pytest.mark.parametrize(
    ("curve", "expected"),
    [
        (dead_zone(0.006), ("dead zone", "±0.006")),
        (saturation(73.5), ("saturation", "±73.5")),
        (PiecewiseLinear(((-1.0, -2.0), (1.0, 3.0))), ("saturation", "−2 … 3")),
        (PiecewiseLinear(((0.0, 0.0),), 0.0, 1.0), ("positive part", "")),
        (dead_zone(0.0, 2.0), ("gain", "2")),
        (saturation(0.0), ("constant", "0")),
        (PiecewiseLinear(((-1.0, 0.0), (0.0, 2.0), (1.0, 1.0)), 0.5, 0.0), ("curve", "3 points")),
        (PiecewiseLinear(((-1.0, 4.0), (0.0, 0.0), (1.0, 4.0))), ("curve", "0 … 4")),
    ],
)  # fmt: skip
def test_curves_have_their_names(curve: PiecewiseLinear, expected: tuple[str, str]) -> None:
    assert kind(curve) == expected


def test_many_equal_curves_are_one_picture() -> None:
    law = LAWS["predictive"]
    assert len(law.curves) > 50
    figure = plot.block_diagram(law)
    assert len(curve_lines(figure)) <= 2
    assert max(figure.get_size_inches()) < 16.0


def any_law(n_u: int, n_x: int, n_w: int, seed: int) -> DiscreteSystem:
    """A law with so many inputs, states and curves, and any of its matrices left out."""
    rng = np.random.default_rng(seed)
    n_y = int(rng.choice([1, 4]))
    rows = {"A": n_x, "B": n_x, "E": n_x, "C": n_y, "D": n_y, "J": n_y, "F": n_w, "G": n_w, "H": n_w}
    columns = {"A": n_x, "C": n_x, "F": n_x, "B": n_u, "D": n_u, "G": n_u, "E": n_w, "J": n_w, "H": n_w}
    given = {key: rng.integers(2) * rng.normal(size=(rows[key], columns[key])) for key in rows}
    given["H"] = np.tril(given["H"], -1)
    return DiscreteSystem(
        inputs=[f"speed_{i}" for i in range(n_u)], outputs=[f"torque_{i}_estimated" for i in range(n_y)],
        states=[f"twist_{i}" for i in range(n_x)], dt=1e-4, **given,
        curves=[saturation(1.0 + i) if i % 2 else dead_zone(0.01 * (i + 1)) for i in range(n_w)],
    )  # fmt: skip


def test_whatever_is_left_out_the_drawing_is_readable() -> None:
    for seed, (n_u, n_x, n_w) in enumerate(product((0, 1, 5), (0, 3), (0, 1, 6))):
        law = any_law(n_u, n_x, n_w, seed)
        figure = plot.block_diagram(law)
        assert_readable(figure)
        assert all(named(figure, signal) == 1 for signal in (*law.inputs, *law.outputs, *law.states))
