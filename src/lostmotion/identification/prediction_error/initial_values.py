"""Start values: from the nameplate, and from the recording where that tells more than a nameplate."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..statistics.levenberg_marquardt import Fit, minimise, sum_of_squares
from .innovations import NAMES, Bandwidth, Predictor, to_theta

Array = NDArray[np.float64]

#: Factors on the nameplate that the first search tries (numerics: a factor of two either way, in steps of √2).
FACTORS = (0.5, 0.71, 1.0, 1.41, 2.0)

#: And on that of the backlash besides (numerics: next to none, for a nameplate with a gap that is not there).
NEXT_TO_NONE = 0.06

#: Factors on torque / stiffness that it tries for a backlash without a nameplate (numerics).
BACKLASH_FACTORS = (0.1, 0.3, 1.0, 3.0, 10.0)

#: Length of the segment of the recording that the search runs over, s, and rows at least (option: its computing time).
SEARCH_TIME, SEARCH_ROWS = 3.0, 5000

#: Points of the search whose innovations are held at once (numerics: as many as a Jacobian has columns).
BATCH = 8

#: Points of the search from which a short fit starts (numerics).
CANDIDATES = 3

#: A second minimum predicts nearly as well (sum of squares within this factor), and differs by this much in a logarithm
#: of inertia, stiffness or backlash (calibrated on the virtual rigs 1 and 2, ``benchmarks/calibrations.py``: there is
#: no second minimum with half and double of them either).
RIVAL_COST, RIVAL_DISTANCE = 1.1, 0.2

#: Damping ratio where the nameplate has no damping (Fietzek & Rinderknecht, section II).
DAMPING_RATIO = 0.02

#: Upper edge of the band in which the drivetrain turns as one rigid body: Hz, and as a share of the nameplate's zero
#: (calibrated on the virtual rigs 1 and 2, whose zero is at 38 Hz: half and double give the same;
#: benchmarks/calibrations.py. With a zero at 3.9 Hz, 8 Hz showed a ninth of the inertia, this share 5 % too much; on
#: development drives 3 to 75 of the zoo with a zero below 40 Hz half and double of it showed the same within 10 %).
RIGID_BAND, RIGID_SHARE = 8.0, 0.4


def rigid_body(
    torque: Array, speed: Array, dt: float, zero: float, pieces: Sequence[slice] = (slice(None),)
) -> tuple[float, float, float]:
    """Total inertia, Coulomb and viscous friction from torque = J·acceleration + M_c·sgn(speed) + d_v·speed.

    Least squares far below the zero (Hz), where neither the shaft nor the gap matters, over all segments together.
    """
    from scipy.signal import butter, sosfiltfilt

    band = min(RIGID_BAND, RIGID_SHARE * zero, 0.1 / dt)
    low = butter(2, band, fs=1.0 / dt, output="sos")
    every = max(1, int(0.005 / dt))
    columns, torques = [], []
    for piece in pieces:
        u, w = sosfiltfilt(low, torque[piece]), sosfiltfilt(low, speed[piece])
        columns.append(np.column_stack([np.gradient(w, dt), np.sign(w), w])[::every])
        torques.append(u[::every])
    x, y = np.concatenate(columns), np.concatenate(torques)
    inertia, coulomb, viscous = np.linalg.lstsq(x, y, rcond=None)[0]
    return float(inertia), float(coulomb), float(viscous)


def complete(start: Drivetrain, predictor: Predictor, fixed: Collection[str]) -> tuple[Array, float]:
    """Parameter vector with a value for everything, and the total inertia that the recording shows.

    Friction comes from the recording where it tells. What the nameplate leaves at zero gets: damping ratio
    0.02, friction of 1 % of the motor torque, a lag of two samples, a backlash of torque / stiffness.
    """
    inertia, coulomb, viscous = rigid_body(
        predictor.torque, predictor.speed, predictor.dt, start.zero_frequency, predictor.pieces
    )
    values = {name: getattr(start, name) for name in NAMES}
    force = float(np.std(predictor.torque))
    fastest = float(np.max(np.abs(predictor.speed)))
    guesses = {
        "coulomb": _near(coulomb, values["coulomb"], 0.01 * force),
        "viscous": _near(viscous, values["viscous"], 0.01 * force / fastest),
        "damping": values["damping"] or DAMPING_RATIO * start.stiffness / (np.pi * start.pole_frequency),
        "backlash": values["backlash"] or force / start.stiffness,
        "lag": values["lag"] or 2.0 * predictor.dt,
    }
    values.update({name: value for name, value in guesses.items() if name not in fixed})
    return to_theta([values[n] for n in NAMES], predictor.dt), inertia


def _near(seen: float, nameplate: float, least: float) -> float:
    """What the recording shows, if it is within a factor of four of the nameplate (or there is none)."""
    if nameplate > 0.0:
        return seen if 0.25 < seen / nameplate < 4.0 else nameplate
    return max(seen, least)


def search(
    theta: Array,
    total: float,
    predictor: Predictor,
    start: Drivetrain,
    fixed: Collection[str],
    bandwidth: Bandwidth,
) -> tuple[Array, Array | None]:
    """The best of a grid over motor inertia, stiffness and backlash, each with the given total inertia.

    Returns
    -------
    (Array, Array or None)
        Start of the fit, and a second minimum of the search if there is one, see ``rival``.
    """
    factors = {
        "inertia_motor": FACTORS,
        "stiffness": FACTORS,
        "backlash": (*FACTORS, NEXT_TO_NONE) if start.backlash > 0.0 else BACKLASH_FACTORS,
    }
    if not 0.3 < total / start.inertia_total < 3.0:
        total = start.inertia_total
    grid = [(1.0,) if name in fixed else values for name, values in factors.items()]
    points = [theta]
    for motor, stiffness, backlash in product(*grid):
        point = theta.copy()
        point[[0, 2, 4]] += np.log([motor, stiffness, backlash])
        if np.exp(point[0]) < 0.8 * total and "inertia_load" not in fixed:
            point[1] = np.log(total - np.exp(point[0]))
        points.append(point)
    part = predictor.part(_liveliest(predictor.torque, predictor.dt))
    batches = np.array_split(points, -(-len(points) // BATCH))
    costs = [sum_of_squares(r) for batch in batches for r in part.residuals(batch, bandwidth)]
    free = [i for i in (0, 1, 2, 4, 5) if NAMES[i] not in fixed]
    best = [points[i] for i in np.argsort(costs)[:CANDIDATES]]
    if not free:
        return best[0], None
    fits = [
        minimise(
            lambda t: part.residual(t, bandwidth),
            lambda t, r: part.jacobian(t, bandwidth, free, r),
            point, free, theta - np.log(20.0), theta + np.log(20.0), iterations=10,
        )
        for point in best
    ]  # fmt: skip
    return min(fits, key=lambda fit: fit.cost).theta, rival(fits)


def rival(fits: Sequence[Fit]) -> Array | None:
    """The best fit that predicts nearly as well as the best of all, and is far from it."""
    best = min(fits, key=lambda fit: fit.cost)
    core = [NAMES.index(name) for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]
    core = [i for i in core if np.isfinite(best.theta[i])]  # a fixed zero has no logarithm
    others = [
        fit
        for fit in fits
        if fit.cost < RIVAL_COST * best.cost
        and np.max(np.abs(fit.theta[core] - best.theta[core])) > RIVAL_DISTANCE
    ]
    return min(others, key=lambda fit: fit.cost).theta if others else None


def _liveliest(torque: Array, dt: float) -> slice:
    """The segment of ``SEARCH_TIME`` with the greatest torque variance."""
    rows = min(torque.size, max(SEARCH_ROWS, int(SEARCH_TIME / dt)))
    starts = np.arange(0, torque.size - rows + 1, max(1, rows // 10))
    first = int(starts[np.argmax([np.var(torque[i : i + rows]) for i in starts])])
    return slice(first, first + rows)
