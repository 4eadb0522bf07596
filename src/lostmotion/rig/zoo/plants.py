"""The plant of a drive of the zoo: its chain of inertias, its gaps, its friction."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...drivetrain import Actuator, Drivetrain, Friction, Shaft
from ..equivalent import eigenfrequencies
from .draws import (
    BACKLASH,
    COULOMB,
    DAMPING_RATIO,
    INERTIA,
    LAG,
    LAWS,
    POLE,
    RATIO,
    SECOND_MODE,
    VISCOUS,
    Draw,
    Rating,
    rating,
)

#: Share of the drives that are rigid, have no gap, a second gap, a soft clutch (of the chains of three or more).
#: (Option.)
RIGID, NO_GAP, SECOND_GAP, SOFT_CLUTCH = 0.1, 1.0 / 6.0, 0.1, 0.1
#: How many drives have so many inertias (option).
MASSES = {"2": 0.4, "3": 0.3, "4": 0.15, "5": 0.15}
#: A further inertia's share of its side; of one between the softest shaft and the gap (option: a joint is small).
SHARE, JOINT_SHARE = (0.005, 0.4), (0.005, 0.15)
#: A further shaft's compliance over that of the softest: usual ones at most, a soft clutch (option).
MOST_COMPLIANCE, CLUTCH_COMPLIANCE = 0.45, (0.5, 2.0)
#: Second gap over the main one (option).
SECOND_GAP_SIZE = (0.03, 0.3)
#: Stribeck rise over the Coulomb level, and the share of rated speed at which it is gone; ratio of the two directions.
#: (Option.)
STRIBECK_RISE, STRIBECK_SPEED, ASYMMETRY = (0.05, 0.5), (0.005, 0.1), (0.5, 2.0)


@dataclass(frozen=True)
class Plant:
    """A chain and its rating; ``windup`` is the first mode's twist at rated torque, rad (0: rigid)."""

    drivetrain: Drivetrain
    rating: Rating
    pole: float
    windup: float


def plant(draw: Draw) -> Plant:
    """The plant of a seed."""
    total, pole = draw.log_uniform("inertia", INERTIA), draw.log_uniform("pole", POLE)
    lag = draw.uniform("lag", *LAG)
    if draw.happens("rigid", RIGID):
        rated = rating(draw, total, math.inf)
        return Plant(
            Drivetrain((total,), (), (_friction(draw, "motor", rated),), Actuator(lag)), rated, pole, 0.0
        )
    ratio = draw.log_uniform("ratio", RATIO)
    motor, load = total / (1.0 + ratio), total * ratio / (1.0 + ratio)
    # A chain's own stiffness differs a little; the rating takes that of two masses.
    stiffness = (2.0 * math.pi * pole) ** 2 * motor * load / total
    rated = rating(draw, total, stiffness)
    chain, gaps = _chain(draw, motor, load, pole)
    windup = rated.torque / stiffness
    chain = replace(chain, shafts=_with_gaps(draw, chain.shafts, gaps, windup), actuator=Actuator(lag))
    return Plant(_with_friction(draw, chain, rated), rated, pole, windup)


def _chain(draw: Draw, motor: float, load: float, pole: float) -> tuple[Drivetrain, list[int]]:
    """A chain without gaps and friction, and the shafts that may have a gap, the main one first.

    Motor and load (kg m2) are all inertia before and behind the main gap's shaft.
    """
    n = int(draw.choice("masses", MASSES))
    rng = draw.stream("chain")
    gap = int(rng.integers(n - 1))
    # Where the gap is: in the softest shaft, or in a joint beside it.
    beside = [i for i in (gap - 1, gap + 1) if 0 <= i < n - 1]
    softest = gap if not beside or rng.random() < 0.5 else int(rng.choice(beside))
    inertias = _inertias(draw, n, gap, softest, motor, load)
    relative = np.exp(rng.uniform(-1.0, 1.0, n - 1))
    relative[softest] = 1.0
    clutch = _soft_clutch(draw, n, softest)
    scale = _further_compliance(draw, inertias, relative, softest, clutch)
    compliance = np.where(np.arange(n - 1) == softest, 1.0, np.minimum(scale * relative, MOST_COMPLIANCE))
    if clutch is not None:
        compliance[clutch] = draw.log_uniform("clutch compliance", CLUTCH_COMPLIANCE)
    frequencies = eigenfrequencies(Drivetrain(inertias, tuple(Shaft(1.0 / c) for c in compliance)))
    stiffness = (pole / frequencies[1]) ** 2 / compliance
    shafts = []
    for i, k in enumerate(stiffness):
        # The softest shaft damps the first mode, each other one the second.
        at = pole if i == softest else pole * frequencies[2] / frequencies[1]
        ratio = draw.log_uniform("damping" if i == softest else f"damping {i}", DAMPING_RATIO)
        shafts.append(Shaft(float(k), float(2.0 * ratio / (2.0 * math.pi * at) * k)))
    others = [i for i in range(n - 1) if i != gap]
    return Drivetrain(inertias, tuple(shafts)), [gap, *others]


def _inertias(draw: Draw, n: int, gap: int, softest: int, motor: float, load: float) -> tuple[float, ...]:
    shares = np.zeros(n)
    for i in range(1, n - 1):
        between = min(gap, softest) < i <= max(gap, softest)
        shares[i] = draw.log_uniform(f"share {i}", JOINT_SHARE if between else SHARE)
    first, second = shares[: gap + 1], shares[gap + 1 :]
    for side in (first, second):
        side *= min(1.0, 0.7 / max(side.sum(), 1e-300))
    first[0], second[-1] = 1.0 - first[1:].sum(), 1.0 - second[:-1].sum()
    return tuple(float(j) for j in (*motor * first, *load * second))


def _soft_clutch(draw: Draw, n: int, softest: int) -> int | None:
    others = [i for i in range(n - 1) if i != softest]
    if not others or not draw.happens("soft clutch", SOFT_CLUTCH):
        return None
    return int(draw.stream("clutch").choice(others))


def _further_compliance(
    draw: Draw, inertias: tuple[float, ...], relative: np.ndarray, softest: int, clutch: int | None
) -> float:
    """Factor on the further shafts' compliances that brings the second mode to its place over the first."""
    if len(inertias) == 2:
        return 1.0
    wanted = draw.log_uniform("second mode", SECOND_MODE)

    def second_mode(scale: float) -> float:
        compliance = np.minimum(scale * relative, MOST_COMPLIANCE)
        compliance[softest] = 1.0
        modes = eigenfrequencies(Drivetrain(inertias, tuple(Shaft(float(1.0 / c)) for c in compliance)))
        return float(modes[2] / modes[1])

    low, high = 1e-5, 1.0
    for _ in range(40):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if second_mode(middle) > wanted else (low, middle)
    return low


def _with_gaps(draw: Draw, shafts: tuple[Shaft, ...], places: list[int], windup: float) -> tuple[Shaft, ...]:
    if draw.happens("no gap", NO_GAP):
        return shafts
    law = draw.choice("law", dict.fromkeys(LAWS, 1.0 / len(LAWS)))
    changed = list(shafts)
    size = draw.log_uniform("backlash", BACKLASH) * windup
    changed[places[0]] = replace(shafts[places[0]], backlash=size, contact=law)
    if len(places) > 1 and draw.happens("second gap", SECOND_GAP):
        small = draw.log_uniform("second gap size", SECOND_GAP_SIZE) * size
        changed[places[1]] = replace(shafts[places[1]], backlash=small, contact=law)
    return tuple(changed)


def _with_friction(draw: Draw, chain: Drivetrain, rated: Rating) -> Drivetrain:
    where = draw.choice("friction", {"load": 0.5, "motor": 0.2, "both": 0.3})
    n = len(chain.inertias)
    motor = Friction() if where == "load" else _friction(draw, "motor", rated)
    load = Friction() if where == "motor" else _friction(draw, "load", rated)
    return replace(chain, frictions=(motor, *(Friction(),) * (n - 2), load))


def _friction(draw: Draw, place: str, rated: Rating) -> Friction:
    level = draw.log_uniform(f"coulomb {place}", COULOMB) * rated.torque
    viscous = draw.log_uniform(f"viscous {place}", VISCOUS) * rated.torque / rated.speed
    ratio = (
        draw.log_uniform(f"asymmetry {place}", ASYMMETRY) if draw.happens(f"asymmetric {place}", 0.3) else 1.0
    )
    levels = (2.0 * level * ratio / (1.0 + ratio), 2.0 * level / (1.0 + ratio))
    stribeck: tuple[tuple[float, float], ...] = ()
    if draw.happens(f"stribeck {place}", 0.5):
        rise = draw.log_uniform(f"rise {place}", STRIBECK_RISE) * level
        gone = draw.log_uniform(f"gone {place}", STRIBECK_SPEED) * rated.speed
        stribeck = ((0.0, rise), (0.3 * gone, 0.5 * rise), (gone, 0.0))
    return Friction(levels, viscous, stribeck=stribeck)
