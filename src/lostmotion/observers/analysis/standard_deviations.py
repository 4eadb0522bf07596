"""Standard deviations of a fixed-gain observer's estimates, sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InvalidInput
from ...recording import Recording
from ...systems import DiscreteSystem
from ...systems.inputs import input_columns
from ..arguments import mapping, number
from ..estimates import deviations
from ..filters.tuning import EIGENMODE_SHARE, eigenmode_numbers

Array = NDArray[np.float64]

#: Samples of the error by default: their root mean square is known to 5 % (option).
SAMPLES = 200


def standard_deviations(
    observer: DiscreteSystem,
    data: Recording | Mapping[str, ArrayLike],
    *,
    process_covariance: Mapping[str, float],
    measurement_covariance: Mapping[str, float],
    eigenmode_share: float = EIGENMODE_SHARE,
    samples: int = SAMPLES,
    seed: int = 0,
) -> Recording:
    """Standard deviations of a fixed-gain observer's estimates over a recording.

    With process noise q and sensor noise v, the observer's model gives the dynamics of the error e = true − estimated
    state::

        e⁺ = A e + E Δw − B v + q,    Δwᵢ = curveᵢ(ẑᵢ + Δzᵢ) − curveᵢ(ẑᵢ),    Δz = F e + H Δw − G v

    A Monte Carlo simulation moves many samples of it along the estimate through the true curves. (One covariance moved
    by the curves' mean slopes is half as large as the errors: it forgets that a wrong side of the gap stays wrong for a
    while.) In the gap the load's error is not corrected, and it grows. While a check replaces a sample by its
    prediction, that sensor corrects nothing, and all errors grow; a missing motor torque counts as known.

    The standard deviations depend on the covariances, so there is no default: those of ``kalman`` are made for the gain
    and are far too large as noises. ``covariances`` fits them to a recording; in physical terms they are (unmodelled
    torque, as the root of its density in Nm·√s, over inertia)² and (noise of one sample)²·dt.

    Parameters
    ----------
    observer : DiscreteSystem
        From ``kalman``, ``h_infinity``, ``disturbance_observer``, ``shaft_torque``, or made by hand; all inputs but
        torque_motor are sensors.
    data : Recording, or mapping of input name → (n,) array
        As for ``observer.run``.
    process_covariance : mapping of state → variance
        Continuous-time density; zero for states that are not named.
    measurement_covariance : mapping of measured signal → variance
        Continuous-time density; zero for signals that are not named.
    eigenmode_share : float
        What eigenmodes beyond the model add to torque_shaft_deviation, as in ``tuning.Tuning``: a share of the
        estimate's own standard deviation over the last ``tuning.EIGENMODE_MEMORY``. Zero where the model is the plant.
    samples : int
        Samples of the error, at least 2; the time grows with it (some 10 µs per row with the default).
    seed : int

    Returns
    -------
    Recording
        ``<signal>_deviation`` for each output ``<signal>_estimated``, in its unit. They start at the steady
        state with all curves at constant values.

    Raises
    ------
    InvalidInput
        For unknown names, negative numbers, and an observer whose error does not settle.

    Notes
    -----
    A nonlinear error's covariance by samples: Evensen 1994, J. Geophysical Research 99, 10143–10162; the settled one by
    doubling: Smith 1968, SIAM J. Applied Mathematics 16, 198–201.
    """
    from ...kernels.law.error_samples import eigenmode_variances, output_spread
    from ...kernels.law.step import law_run

    if not isinstance(observer, DiscreteSystem):
        expected, remedy = (
            "a fixed-gain observer",
            "A filter gives its standard deviations beside its estimates.",
        )
        raise InvalidInput("standard_deviations.observer", repr(observer), expected, remedy)
    if not (isinstance(samples, int) and samples >= 2):
        raise InvalidInput(
            "standard_deviations.samples", repr(samples), "a whole number, at least 2", "Give more."
        )
    sensors = tuple(name for name in observer.inputs if name != "torque_motor")
    eigenmodes = eigenmode_numbers("standard_deviations.eigenmode_share", eigenmode_share, observer.dt)
    q = _densities("process_covariance", observer.states, observer.states, process_covariance)
    r = _densities("measurement_covariance", observer.inputs, sensors, measurement_covariance)
    noise = q * observer.dt, r / observer.dt
    time, inputs = input_columns(observer.name, observer.inputs, observer.dt, data)
    arguments, faults = law_run(_curve_arguments(observer).tables(), observer.init(), inputs)
    rng = np.random.default_rng(seed)
    start = rng.multivariate_normal(np.zeros(q.size), _settled(observer, *noise), samples, method="eigh")
    of_state, of_input, of_curve, curves, checked = _tables(observer)
    levels = np.sqrt(noise[0]), np.sqrt(noise[1])
    spread = output_spread(
        arguments, faults, of_state, of_input, of_curve, curves, checked, levels, start, rng
    )
    if "torque_shaft_estimated" in observer.outputs:
        i = observer.outputs.index("torque_shaft_estimated")
        estimate, _ = law_run(observer.tables(), observer.init(), inputs)
        spread[:, i] = np.sqrt(spread[:, i] ** 2 + eigenmode_variances(*eigenmodes, estimate[:, i]))
    names = deviations(*(name.removesuffix("_estimated") for name in observer.outputs))
    signals = {name: spread[:, i] for i, name in enumerate(names)}
    return Recording(
        time=time, signals=signals, origin=dict.fromkeys(names, "estimated"), meta={"seed": seed}
    )


def _densities(
    where: str, names: tuple[str, ...], noisy: tuple[str, ...], given: Mapping[str, float]
) -> Array:
    """In the order of ``names``; only those in ``noisy`` may have one."""
    given = mapping(f"standard_deviations.{where}", given)
    unknown = sorted(set(given) - set(noisy))
    if unknown:
        raise InvalidInput(
            f"standard_deviations.{where}", f"{unknown}", f"names out of {noisy}", "Check the names."
        )
    values = np.array(
        [number(f"standard_deviations.{where}[{name!r}]", given.get(name, 0.0)) for name in names]
    )
    if not np.all(np.isfinite(values) & (values >= 0.0)):
        raise InvalidInput(
            f"standard_deviations.{where}", f"{given}", "zero or positive numbers", "Give variances."
        )
    return values


def _curve_arguments(observer: DiscreteSystem) -> DiscreteSystem:
    """The same observer, whose outputs are the arguments of its curves."""
    names = tuple(f"argument_{i}" for i in range(len(observer.curves)))
    return replace(observer, outputs=names, C=observer.F, D=observer.G, J=observer.H)


def _tables(observer: DiscreteSystem) -> tuple[Any, ...]:
    """The observer as ``kernels.law.error_samples`` reads it."""
    o, curves = observer, observer.curves
    most = max((len(curve.points) for curve in curves), default=0)
    points, values = np.zeros((2, len(curves), most))
    slopes = np.zeros((len(curves), most + 1))
    for i, curve in enumerate(curves):
        points[i, : len(curve.points)], values[i, : len(curve.points)] = np.transpose(curve.points)
        slopes[i, : len(curve.slopes)] = curve.slopes
    counts = np.array([len(curve.points) for curve in curves], dtype=np.int64)
    checked = np.full(len(o.inputs), -1, dtype=np.int64)
    for i, check in enumerate(o.checks):
        if check.missing_only:
            continue
        checked[o.inputs.index(check.input)] = i
    return (
        (o.F, o.A, o.C, o.P), (o.G, o.B, o.D), (o.H, o.E, o.J, o.R), (points, values, slopes, counts), checked
    )  # fmt: skip


def _settled(observer: DiscreteSystem, process: Array, sensor: Array) -> Array:
    """Covariance of the error with every curve at a constant value: Σ Aⁱ (Q + B R Bᵀ) Aⁱᵀ, by doubling."""
    a = observer.A
    radius = float(np.max(np.abs(observer.poles()), initial=0.0))
    if not radius < 1.0:
        raise InvalidInput(
            "standard_deviations.observer", f"a pole at {radius:g}", "all poles within the unit circle",
            "Take an observer that corrects all its states.",
        )  # fmt: skip
    covariance = np.diag(process) + (observer.B * sensor) @ observer.B.T
    while np.max(np.abs(a), initial=0.0) > 1e-12:
        covariance = covariance + a @ covariance @ a.T
        a = a @ a
    return np.asarray(0.5 * (covariance + covariance.T))
