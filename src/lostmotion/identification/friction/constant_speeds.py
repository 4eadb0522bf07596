"""Friction against speed from a series of constant speeds: Coulomb, viscous and Stribeck part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...argument_checks import checks_arguments, not_negative
from ...drivetrain import Friction
from ...errors import InvalidInput
from ...recording import Recording
from ..statistics.estimates import Estimates, Interval
from . import problems as problem
from .plateaus import PARTS, SETTLING, SHORTEST, of_motion, of_reference
from .result import Floats, torque_to_use

#: A plateau counts as steady while its speed scatters by less than this part of its mean (calibrated on plateaus of
#: which the slowest slip and stick, seeds 1 to 4: half and double leave out the same ones; benchmarks/calibrations.py):
#: else it slips and sticks.
STEADY = 0.3
#: Shapes of the Stribeck rise, exp(−(speed/stribeck_speed)^exponent) (physics): Tustin's and the Gaussian one.
EXPONENTS = (1.0, 2.0)
#: Absolute speeds, in Stribeck speeds, of the piecewise-linear curve that ``Friction`` takes (numerics: corners
#: of its chords, closer where it bends).
KNOTS = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FrictionLadder(Estimates):
    """Friction over speed::

        torque = offset + sgn(speed)·(coulomb + stribeck·exp(−(abs(speed)/stribeck_speed)^exponent)) + viscous·speed

    Values: ``coulomb`` (or ``coulomb_plus``, ``coulomb_minus``; Nm), ``viscous`` (likewise; Nm s/rad), ``offset`` (Nm,
    where both directions were recorded and share their levels), ``stribeck`` (Nm), ``stribeck_speed`` (rad/s).

    Attributes
    ----------
    exponent : float
        Of the better of the two shapes.
    speed, torque, margin : (m,) arrays, rad/s and Nm
        Each plateau's means and half the 95 % interval of its torque.
    steady : (m,) bool array
        The plateaus that the fit used.
    """

    exponent: float
    speed: Floats
    torque: Floats
    margin: Floats
    steady: NDArray[np.bool_]

    def curve(self, speed: ArrayLike) -> Floats:
        """The fitted torque (Nm) at speeds ≠ 0 (rad/s); mirrored where one direction only was recorded."""
        w = np.asarray(speed, dtype=float)
        return _model(w, {n: v for n, v in self.values.items() if v is not None}, self.exponent)

    def friction(self) -> Friction:
        """For a ``Drivetrain``: the offset goes into the Coulomb levels, the Stribeck rise into a polyline."""
        v = {n: float(x) for n, x in self.values.items() if x is not None}
        if not v:
            raise InvalidInput(
                "FrictionLadder.friction", "no friction", "an identified one", "See its problems."
            )
        offset = v.get("offset", 0.0)
        one = v.get("coulomb", v.get("coulomb_plus", v.get("coulomb_minus", 0.0)))
        levels = (v.get("coulomb_plus", one) + offset, v.get("coulomb_minus", one) - offset)
        slopes = [x for n, x in v.items() if n.startswith("viscous")]
        rise: tuple[tuple[float, float], ...] = ()
        if "stribeck" in v:
            last = np.exp(-(KNOTS[-1] ** self.exponent))
            rise = tuple(
                (k * v["stribeck_speed"], v["stribeck"] * max(float(np.exp(-(k**self.exponent)) - last), 0.0))
                for k in KNOTS
            )
        return Friction(levels, sum(slopes) / len(slopes), stribeck=rise)


@checks_arguments
def friction_ladder(
    recording: Recording,
    *,
    speed: str = "speed_motor",
    torque: str | None = None,
    reference: str = "speed_reference",
    plateaus: Sequence[tuple[float, float]] | None = None,
    inertia: float = 0.0,
    asymmetric: bool = False,
    stribeck: bool = True,
) -> FrictionLadder:
    """Mean torque over mean speed of each plateau of a speed-controlled run, and the curve through them.

    Plateaus are where the reference stands still; without a reference, where the speed does; or the windows given.
    Their first 40 % are left out. Of a plateau
    whose speed scatters by 30 % (slip and stick) the mean means nothing: it is shown and not used. The curve is
    fitted with each plateau's own weight; its intervals follow from the scatter about it where that is larger;
    that of the rise at rest, which is extrapolated from the slowest plateau, contains both shapes.

    Parameters
    ----------
    recording : Recording
    speed, torque, reference : str
        Signals; the torque's default is the measured one where there is one.
    plateaus : sequence of (start, stop), s, optional
        Instead of those that are found.
    inertia : float, kg m2
        If given, what is left of acceleration is taken off the torque.
    asymmetric : bool
        Levels and slopes for each direction, with one Stribeck shape.
    stribeck : bool
        Whether a rise towards rest is looked for. Without it two plateaus less are needed.

    Source: Armstrong-Hélouvry, Dupont & Canudas de Wit, Automatica 30 (1994) 1083, section 3 (the curve).
    """
    used, problems = torque_to_use(recording, torque)
    if plateaus is not None:
        windows = list(plateaus)
    elif reference in recording:
        windows = of_reference(recording, reference)
    else:
        windows = of_motion(recording, speed)
    not_negative("friction_ladder.inertia", inertia)
    rows = [_plateau(recording.window(a, b), speed, used, inertia) for a, b in windows]
    found = np.array(rows).reshape(-1, 4)
    w, m, margin = found[:, 0], found[:, 1], found[:, 2]
    steady = found[:, 3] < STEADY
    if not steady.all():
        problems += (problem.unsteady_plateaus(w[~steady].tolist()),)
    values, intervals, exponent = _fit(w[steady], m[steady], margin[steady], asymmetric, stribeck)
    if not values:
        problems += (problem.too_few_plateaus(int(steady.sum()), stribeck),)
        values = {"coulomb": None, "viscous": None}
    values |= {n: None for n in ("stribeck", "stribeck_speed") if n not in values}
    return FrictionLadder(
        values=values, intervals=intervals, problems=problems, exponent=exponent,
        speed=w, torque=m, margin=margin, steady=steady,
    )  # fmt: skip


def _plateau(part: Recording, speed: str, torque: str, inertia: float) -> tuple[float, float, float, float]:
    """Mean speed, mean torque, its margin, scatter of the speed over its mean."""
    from scipy.stats import t as student

    skip = round(SETTLING * len(part))
    w, m = part[speed][skip:], part[torque][skip:]
    if w.size <= 2 * PARTS:
        raise InvalidInput(
            "friction_ladder", f"a plateau of {len(part)} samples", f"{SHORTEST} or more", "Hold it longer."
        )
    length = (w.size - 1) // PARTS
    # One sample more of the speed: a torque acts from its row to the next.
    edges = part[speed][len(part) - 1 - length * PARTS :: length]
    rate = np.diff(edges) / (length * part.dt)
    parts = m[-1 - length * PARTS : -1].reshape(PARTS, length).mean(axis=1) - inertia * rate
    margin = float(student.ppf(0.975, PARTS - 1)) * float(parts.std(ddof=1)) / np.sqrt(PARTS)
    return float(w.mean()), float(parts.mean()), margin, float(w.std() / max(abs(w.mean()), 1e-300))


def _model(w: Floats, values: Mapping[str, float], exponent: float) -> Floats:
    nan = float("nan")
    plus = values.get("coulomb_plus", values.get("coulomb", nan))
    minus = values.get("coulomb_minus", values.get("coulomb", nan))
    v_plus = values.get("viscous_plus", values.get("viscous", nan))
    v_minus = values.get("viscous_minus", values.get("viscous", nan))
    rise = values.get("stribeck", 0.0) * np.exp(
        -((np.abs(w) / values.get("stribeck_speed", 1.0)) ** exponent)
    )
    level = np.where(w > 0.0, plus, minus) + rise + np.where(w > 0.0, v_plus, v_minus) * np.abs(w)
    return np.asarray(values.get("offset", 0.0) + np.sign(w) * level, dtype=float)


def _fit(
    w: Floats, m: Floats, margin: Floats, asymmetric: bool, stribeck: bool
) -> tuple[dict[str, float | None], dict[str, Interval], float]:
    """The better of the two Stribeck shapes, or none of them where the rise may as well be zero."""
    names: tuple[str, ...] = ("coulomb", "viscous")
    sides = [s for s, any_ in (("plus", (w > 0.0).any()), ("minus", (w < 0.0).any())) if any_]
    if asymmetric:
        names = (*(f"coulomb_{s}" for s in sides), *(f"viscous_{s}" for s in sides))
    elif len(sides) == 2:
        names = (*names, "offset")
    plain = _one_fit(w, m, margin, names, 1.0)
    shaped = [
        (fit, e)
        for e in (EXPONENTS if stribeck else ())
        if (fit := _one_fit(w, m, margin, (*names, "stribeck", "stribeck_speed"), e))
    ]
    fits = [
        (fit, e) for fit, e in shaped if fit[1]["stribeck"][0] > 0.0 and fit[1]["stribeck_speed"][0] > 0.0
    ]
    if fits:
        best, exponent = min(fits, key=lambda f: f[0][2])
        # The rise at rest is extrapolated: how far depends on the shape, which constant speeds hardly identify.
        low, high = (dict(fit[1]) for fit, _ in (fits[0], fits[-1]))
        intervals = {
            n: (min(low[n][0], high[n][0]), max(low[n][1], high[n][1])) if n.startswith("stribeck") else i
            for n, i in best[1].items()
        }
        return best[0], intervals, exponent
    return ({}, {}, 1.0) if plain is None else (plain[0], plain[1], 1.0)


def _one_fit(
    w: Floats, m: Floats, margin: Floats, names: tuple[str, ...], exponent: float
) -> tuple[dict[str, float | None], dict[str, Interval], float] | None:
    """Values, intervals and weighted sum of squares; None with fewer plateaus than one more than parameters."""
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    if w.size <= len(names):
        return None
    # Half an interval is two standard deviations; a floor keeps one lucky plateau from outvoting the rest.
    sigma = 0.5 * np.maximum(margin, max(0.2 * float(np.median(margin)), 1e-6 * float(np.abs(m).max())))
    guess = {"stribeck": 0.1 * np.abs(m).min(), "stribeck_speed": 2.0 * np.abs(w).min()}
    start = np.array([guess.get(n, np.abs(m).min() if n.startswith("coulomb") else 0.0) for n in names])
    scale = np.array(
        [np.abs(m).min() if "viscous" not in n else np.ptp(np.abs(m)) / np.ptp(np.abs(w)) for n in names]
    )
    if "stribeck_speed" in names:
        scale[-1] = start[-1]

    def residual(x: Floats) -> Floats:
        return (_model(w, dict(zip(names, (x * scale).tolist(), strict=True)), exponent) - m) / sigma

    lower = np.where(np.array(names) == "stribeck_speed", 1e-3, -np.inf)
    best: Any = least_squares(residual, start / scale, bounds=(lower, np.inf), x_scale="jac")
    free = w.size - len(names)
    inflate = max(1.0, 2.0 * best.cost / free)
    covariance = np.linalg.pinv(best.jac.T @ best.jac) * inflate
    margins = float(student.ppf(0.975, free)) * np.sqrt(np.diag(covariance)) * scale
    found = best.x * scale
    values: dict[str, float | None] = dict(zip(names, found.tolist(), strict=True))
    intervals = {n: (float(v - h), float(v + h)) for n, v, h in zip(names, found, margins, strict=True)}
    return values, intervals, 2.0 * float(best.cost)
