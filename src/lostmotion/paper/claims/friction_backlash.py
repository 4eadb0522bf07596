"""Claims of section II: friction from the torque step, backlash from the locked wheel."""

from __future__ import annotations

from collections.abc import Mapping

from ...identification.backlash.locked_load import LockedBacklash
from ...identification.friction.result import FrictionFit
from ..claim import Claim, judged, signed
from ..experiments import LOCKED_TORQUE, Experiments

#: Largest errors, as shares (option): of the friction, of the backlash.
FRICTION, BACKLASH = 0.03, 0.01


def claims(e: Experiments) -> list[Claim]:
    truth = e.friction_run.truth.parameters
    return [friction(e.friction, truth), backlash(e.locked, truth)]


def friction(found: FrictionFit, truth: Mapping[str, float | None]) -> Claim:
    """Coulomb and viscous friction, against the line through the rig's friction curve over the speeds of the test."""
    names = ("coulomb", "viscous")
    off = tuple(_off(found.values[name], truth[name]) for name in names)
    return Claim(
        name="friction from the torque step",
        says="With total inertia and torque known, M_c and d_v can be adjusted so that the simulated torque "
        "step matches the measured one.",
        where="section II, Fig. 5",
        quantity="errors of Coulomb and viscous friction, %",
        value=tuple(100.0 * x for x in off),
        tolerance=f"both at most {100 * FRICTION:g} %",
        verdict=judged(*(abs(x) <= FRICTION for x in off)),
        sentence=f"M_c is {signed(100 * off[0], '+.2f')} % and d_v {signed(100 * off[1], '+.2f')} % off the "
        "straight line through the rig's friction, which rises towards rest as the model's does not.",
    )


def backlash(found: LockedBacklash, truth: Mapping[str, float | None]) -> Claim:
    """The total free angle, the wind-up of the shaft removed."""
    off = _off(found.values["backlash"], truth["backlash"])
    stiffness, true = found.values["stiffness"], truth["backlash"]
    wind_up = 2.0 * LOCKED_TORQUE / stiffness / true if stiffness and true else float("nan")
    return Claim(
        name="backlash from the locked wheel",
        says="The maximum backlash can be measured easily by closing the brakes and applying a small oscillating "
        "torque.",
        where="section II",
        quantity="error of the backlash, %",
        value=(100.0 * off,),
        tolerance=f"at most {100 * BACKLASH:g} %",
        verdict=judged(abs(off) <= BACKLASH),
        sentence=f"The locked wheel gives the free angle {signed(100 * off, '+.2f')} % off. The wind-up of "
        f"the shaft must be removed: at {LOCKED_TORQUE:g} Nm it would add {100 * wind_up:.0f} %.",
    )


def _off(value: float | None, true: float | None) -> float:
    """Relative error; infinite where nothing was found."""
    return float("inf") if value is None or true is None else value / true - 1.0
