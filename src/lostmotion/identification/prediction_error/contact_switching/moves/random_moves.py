"""Random moves of the best candidate, and descents from there: they find minima that no single change leads to."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np

from ..filter import LAWS, ContactFilter
from ..likelihood import FITTED_LEVEL, Box, Candidate, cost_of, descend, polish, rates_first, side_by_side
from ..parameter_vector import INDEX, pole_of
from ..starts.from_drivetrain import unknown
from ..structures.shaft_inertias import FOURTH, THIRD, Place, placed, with_dropped
from .choices import is_late, with_split

#: Moves of a round, of which the best few go on to the end; rounds without a lower cost after which it ends, and rounds
#: at most (numerics).
WIDTH, FOLLOWED, PATIENCE, ROUNDS = 8, 2, 8, 24
#: Steps of a descent at each noise level, and of one at the sensor's alone (numerics).
STEPS, STEPS_ALONE = 4, 6
#: Chance that one of the groups changes (numerics: two to three of four on average), that a choice is made otherwise or
#: a third inertia dropped, and that a backlash stays near its own.
GROUP, CHOICE, NEAR = 0.5, 0.2, 0.5
#: Standard deviations of logarithms, one of them at random (numerics: within a minimum, and far from it).
SIZES = (0.1, 0.3, 0.6)
#: Backlash over the wind-up at the torque's standard deviation; share of a third inertia, and its part of the
#: compliance (numerics: what shows).
GAPS, SHARES, COMPLIANCES = (0.02, 12.0), (0.01, 0.7), (0.03, 0.97)
#: A drop of the cost that counts (numerics).
LOWER = 1e-3


def wandering(
    best: Candidate,
    rows: ContactFilter,
    box: Box,
    free: Collection[int],
    long: Callable[[], bool] = lambda: False,
    patience: int = PATIENCE,
) -> list[Candidate]:
    """Ends over some rows: each round moves what is lowest so far. ``free``: what may be changed; ``long``: whether no
    further round begins; ``patience``: rounds without a lower cost after which it ends."""
    found: list[Candidate] = []
    generator, waited = np.random.default_rng(0), 0
    at = replace(best.over(rows), level=rows.floor)
    best = replace(best, flt=at, cost=at.run(best.theta).cost)
    for _ in range(ROUNDS):
        if long():
            break
        moves = [moved(best, each, box, free) for each in generator.spawn(WIDTH)]
        ends = side_by_side(lambda move: _end(move, box), list(enumerate(moves)))
        few = sorted(ends, key=cost_of)[:FOLLOWED]
        few = side_by_side(lambda one: polish(one, one.flt, box), few)
        lowest, waited = min(few, key=cost_of), waited + 1
        found += few
        if lowest.cost < best.cost - LOWER:
            best, waited = lowest, 0
        elif waited == patience:
            break
    return found


def _end(numbered: tuple[int, Candidate], box: Box) -> Candidate:
    """Of a descent that comes down through the noise levels, or stays at the sensor's with rates of its own: either
    finds what the other does not. It divides out innovations that are too large, its end is judged with them."""
    number, begun = numbered
    flt = replace(begun.flt, charged=False)
    if number % 2:
        found = descend(begun.start, flt, begun.theta, begun.free, box, FITTED_LEVEL, STEPS)
        theta = found.theta
    else:
        theta = rates_first(replace(begun, flt=flt), box, STEPS_ALONE).theta
    return replace(begun, theta=theta, cost=begun.flt.run(theta).cost)


def moved(best: Candidate, rng: np.random.Generator, box: Box, free: Collection[int]) -> Candidate:
    """The candidate with other inertias, another friction, another backlash or another third inertia, or several of
    these, in the drive's dimensionless numbers."""
    changes = rng.random(4) < GROUP
    changes[rng.integers(4)] = True
    one = _with_other_choices(best, rng)
    for change, move in zip(changes, (_inertias, _friction, _gap, _further), strict=True):
        one = move(one, rng, free) if change else one
    own = [place for place in one.free if np.isfinite(one.theta[place])]
    theta = one.theta.copy()
    theta[own] = np.clip(theta[own], box.lower[own], box.upper[own])
    rates, now = unknown(one.flt, 2.0 * np.pi * pole_of(theta)), one.values
    # Rates at which the filter is not lost where the move has led.
    least = {name: max(now[name], rates[name]) for name in ("motor_rate", "load_rate", "impact")}
    return replace(one, theta=one.flt.changed(theta, **least), start="moved")


def _with_other_choices(one: Candidate, rng: np.random.Generator) -> Candidate:
    ramp, law, delayed = rng.random(3) < CHOICE
    change: dict[str, Any] = {}
    if ramp:
        change["ramp"] = not one.flt.ramp
    if law:
        change["law"] = list(LAWS)[int(rng.integers(len(LAWS)))]
    if is_late(one) and rng.random() < CHOICE:
        one = with_split(one, rng.random())
    theta = one.theta.copy()
    if delayed and INDEX["delay"] in one.free:
        theta[INDEX["delay"]] += rng.uniform(-1.0, 1.0)
    return replace(one, theta=theta, flt=replace(one.flt, **change))


def _inertias(one: Candidate, rng: np.random.Generator, free: Collection[int]) -> Candidate:
    """Another inertia ratio, pole and damping; the total inertia and the gap over the wind-up stay."""
    now, size = one.values, float(rng.choice(SIZES))
    motor, load = now["inertia_motor"], now["inertia_load"]
    ratio = load / motor * np.exp(2.0 * size * rng.standard_normal())
    other = {
        "inertia_motor": (motor + load) / (1.0 + ratio),
        "inertia_load": (motor + load) * ratio / (1.0 + ratio),
    }
    compliance = (1.0 / motor + 1.0 / load) / sum(1.0 / value for value in other.values())
    other["stiffness"] = now["stiffness"] * compliance * np.exp(2.0 * size * rng.standard_normal())
    other["damping"] = now["damping"] * np.exp(3.0 * size * rng.standard_normal())
    other["backlash"] = now["backlash"] * now["stiffness"] / other["stiffness"]
    return _changed(one, other, free)


def _gap(one: Candidate, rng: np.random.Generator, free: Collection[int]) -> Candidate:
    """Another backlash: near its own, or any."""
    place, now = INDEX["backlash"], one.values
    if place not in free:
        return one
    windup = one.flt.torque_deviation / now["stiffness"]
    if now["backlash"] > 0.0 and rng.random() < NEAR:
        gap = now["backlash"] * np.exp(float(rng.choice(SIZES)) * rng.standard_normal())
    else:
        gap = windup * np.exp(rng.uniform(*np.log(GAPS)))
    # A constant torque on the motor may hold the gap on one side, so that it does not show.
    own = sorted({*one.free, *({place, INDEX["torque_offset"]} & {*free})})
    return _changed(replace(one, free=own), {"backlash": gap, "torque_offset": 0.0}, free)


def _friction(one: Candidate, rng: np.random.Generator, free: Collection[int]) -> Candidate:
    """More or less friction, at the motor, at the load or at both; as much of it Coulomb's as now, all or any part."""
    now, size, speed = one.values, float(rng.choice(SIZES)), max(one.flt.speed_deviation, 1e-300)
    coulomb, viscous = (now[name] + now[f"{name}_motor"] for name in ("coulomb", "viscous"))
    whole = max(coulomb + viscous * speed, 1e-300)
    part, dry = (float(rng.choice([own, 1.0, rng.random()])) for own in (0.0, coulomb / whole))
    whole *= np.exp(size * rng.standard_normal())
    other: dict[str, float] = {}
    for name, torque in (("coulomb", whole * dry), ("viscous", whole * (1.0 - dry) / speed)):
        other |= {name: torque * (1.0 - part), f"{name}_motor": torque * part}
    return _changed(one, other, free)


def _further(one: Candidate, rng: np.random.Generator, free: Collection[int]) -> Candidate:
    """A third inertia anywhere, or none; a fourth anywhere, or none, where there is a third."""
    third = bool(np.isfinite(one.theta[THIRD[0]]))
    fourth = third and {*FOURTH} <= {*free} and bool(rng.random() < 0.5)
    own = FOURTH if fourth else THIRD
    if not {*own} <= {*free}:
        return one
    if np.isfinite(one.theta[own[0]]) and rng.random() < CHOICE:
        return with_dropped(one, own if fourth else (*THIRD, *FOURTH))
    place = Place(
        float(np.exp(rng.uniform(*np.log(SHARES)))),
        float(rng.uniform(*COMPLIANCES)),
        behind=bool(rng.random() < 0.5),
        fourth=fourth,
    )
    flt, theta = placed(one, place, one.flt)
    return replace(one, flt=flt, theta=theta, free=sorted({*one.free, *own}))


def _changed(one: Candidate, values: dict[str, float], free: Collection[int]) -> Candidate:
    """With what of the values may be changed."""
    return replace(
        one, theta=one.flt.changed(one.theta, **{n: v for n, v in values.items() if INDEX[n] in free})
    )
