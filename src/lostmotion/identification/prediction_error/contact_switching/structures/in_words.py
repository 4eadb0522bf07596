"""Which structure the model of an identification has, and which others would predict as well, in words."""

from __future__ import annotations

from collections.abc import Sequence

from ...gain_schedule import Stage
from ...innovations import NAMES as TOLD
from ...innovations import Predictor
from ...result import Structure
from ..likelihood import Candidate
from ..likelihood_ratio import alike
from ..parameter_vector import pole_of
from ..starts.slow_motion import SlowFriction

#: Shares of all Coulomb friction below which one end has none, and it does not rise towards rest; of the wind-up at
#: the torque's deviation from which a gap counts (option: too little to be named); of that deviation from which a
#: constant torque does (numerics: on development drives without one up to 0.06 came out).
ONE_END, RISING, GAP, CONSTANT = 0.05, 0.05, 0.01, 0.1

Parts = tuple[str, ...]


def structure_of(
    predictor: Predictor, stage: Stage, compared: Sequence[Candidate], judged: bool, load_torque: bool
) -> Structure:
    """Of the fit, or of the first of the candidates; those that predict like the best of them are the others.

    Parameters
    ----------
    compared : sequence of Candidate
        First that whose values are reported, or agree with them; empty where the fit stood at first sight.
    judged : bool
        Whether the second estimator judged the fit.
    load_torque : bool
        Whether the fit had a slow load torque.
    """
    if not compared:
        return Structure(_of_fit(predictor, stage, load_torque) if stage.free else (), (), judged)
    told = parts_of(compared[0]) if stage.free else ()
    best = min(compared, key=lambda one: one.cost)
    others = dict.fromkeys(parts_of(one) for one in compared if alike(one, best))
    return Structure(told, tuple(parts for parts in others if parts != told), judged)


def _of_fit(predictor: Predictor, stage: Stage, load_torque: bool) -> Parts:
    """The observer of constant gain has friction at the load, and that of the motor as the nameplate gives it."""
    drivetrain = predictor.drivetrain(stage.fit.theta)
    gap = "no gap"
    if drivetrain.backlash > 0.0:
        gap = "a gap" if TOLD.index("backlash") in stage.free else "a gap as on the nameplate"
    return (
        _masses(0.0 if predictor.joint_piece is None else predictor.joint_piece[0]),
        gap,
        _friction(drivetrain.coulomb, drivetrain.coulomb_motor),
        *(("a slow load torque",) if load_torque else ()),
    )


def parts_of(candidate: Candidate) -> Parts:
    """The parts of what the contact-switching filter has as a model."""
    flt, v = candidate.flt, candidate.values
    torque = flt.torque_deviation
    friction = v["coulomb"] + v["coulomb_motor"]
    rising = v["rise"] * v["coulomb"] + v["rise_motor"] * v["coulomb_motor"]
    constant = abs(SlowFriction.of(flt, pole_of(candidate.theta)).constant) > CONSTANT * torque
    gap = v["backlash"] * v["stiffness"] > GAP * torque
    rigid = candidate.start == "rigid"
    parts = [
        "one rigid mass" if rigid else _masses(v["share"], flt.behind, v["share_fourth"], flt.fourth_behind),
        "a gap" if gap else "no gap",
        _friction(v["coulomb"], v["coulomb_motor"]),
        "friction that rises towards rest" if rising > RISING * friction > 0.0 else "",
        "a slow load torque" if flt.drifts else "",
        # Friction that differs by direction is that beside one that does not, also at rest.
        "a constant torque" if constant and not flt.drifts else "",
        f"the {flt.law.replace('_', '-')} contact" if gap and flt.law != "viscoelastic" else "",
        "a torque that goes straight from row to row" if flt.ramp else "",
    ]
    return tuple(part for part in parts if part and not (rigid and part == "no gap"))


def _masses(share: float, behind: bool = False, fourth: float = 0.0, fourth_behind: bool = False) -> str:
    if not share > 0.0:
        return "two masses"
    if fourth > 0.0:
        where = {0: "two of the motor's on the shaft", 2: "two of the load's behind the gap"}
        return f"four masses, {where.get(behind + fourth_behind, 'one on the shaft, one behind the gap')}"
    whose = "load's behind the gap" if behind else "motor's on the shaft"
    return f"three masses, {100.0 * share:.2g} % of the {whose}"


def _friction(load: float, motor: float) -> str:
    if not load + motor > 0.0:
        return "no Coulomb friction"
    share = motor / (load + motor)
    if share < ONE_END:
        return "friction at the load"
    return "friction at the motor" if share > 1.0 - ONE_END else "friction at both ends"
