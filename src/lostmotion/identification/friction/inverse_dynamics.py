"""Inertia and friction of a rigid drive from any motion: inverse dynamics by least squares; and its simulation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...argument_checks import checks_arguments, not_negative
from ...errors import InvalidInput
from ...recording import Recording
from ..statistics.block_covariance import sandwich, student_factor
from ..statistics.regression import linear_fit
from .result import Floats, FrictionFit, checked_inertia, reported, torque_to_use

#: Samples in, one sample out by default (option: that of the EMPS benchmark at 1 kHz, Janot, Gautier & Brunot 2019).
DECIMATION = 10
#: Cut-off of the speed whose sign the friction takes, over the sample rate (calibrated on EMPS at 1 kHz: half and
#: double give the published values within 0.06 % as well; benchmarks/calibrations.py).
SIGN_CUTOFF = 0.1
#: Decimated samples dropped at both ends: the filter is ±10 of them long, but its far ends weigh little (numerics).
EDGE = 2


@checks_arguments
def rigid_drive(
    recording: Recording,
    *,
    angle: str = "angle_motor",
    torque: str | None = None,
    inertia: float | None = None,
    asymmetric: bool = False,
    decimation: int = DECIMATION,
) -> FrictionFit:
    """Inverse dynamics of one inertia, linear in its parameters, over any motion with reversals::

        torque = inertia·acceleration + viscous·speed + coulomb·sgn(speed) + offset

    Speed and acceleration are central differences of the angle, unfiltered: then torque and every column go
    through one linear-phase filter (FIR, cut-off at the decimated raster), which leaves a linear model true.
    Only sgn(speed) needs a smooth speed: zero-phase Butterworth, 4th order, a tenth of the sample rate. In closed
    loop, noise of the angle reaches the torque and biases the fit; at ordinary gains that is small (EMPS: 0.2 %).

    A translational drive is the same with mass (kg) for inertia, force (N) for torque, m for rad.

    Parameters
    ----------
    recording : Recording
        A raster of equal steps.
    angle, torque : str
        Signals; the torque's default is the measured one where there is one.
    inertia : float, optional, kg m2
        Where it is known; else it is identified.
    asymmetric : bool
        Coulomb and viscous friction for each direction instead of one offset: at one speed in each direction
        the two cannot be separated.
    decimation : int

    Returns
    -------
    FrictionFit
        Of the torque, on the decimated raster.

    Source: Janot, Gautier & Brunot, nonlinearbenchmark.org (EMPS), whose filtering differs.
    """
    inertia = checked_inertia(inertia, "rigid_drive")
    used, problems = torque_to_use(recording, torque)
    names, x, y, time = regressors(recording, angle, used, asymmetric, decimation)
    known = 0.0 * y
    if inertia is not None:
        names, x, known = names[1:], x[1:], inertia * x[0]
    fit = linear_fit(x, y - known)
    values, intervals, sources, more = reported(names, fit.values, fit.margins, inertia, "rigid_drive")
    return FrictionFit(
        values=values,
        intervals=intervals,
        sources=sources,
        problems=(*problems, *more),
        signal=used,
        time=time,
        torque=y,
        measured=y,
        fitted=fit.fitted + known,
        relative_error=float(np.linalg.norm(fit.residual) / np.linalg.norm(y)),
    )


def regressors(
    recording: Recording, angle: str, torque: str, asymmetric: bool, decimation: int
) -> tuple[tuple[str, ...], Floats, Floats, Floats]:
    """Names (p), columns (p, m), torque (m,) and time (m,) of the inverse dynamics, filtered and decimated."""
    not_negative("rigid_drive.decimation", decimation, positive=True)
    if len(recording) < 40 * decimation:
        raise InvalidInput(
            "rigid_drive",
            f"{len(recording)} samples",
            f"at least {40 * decimation}",
            "Record longer, or lower the decimation.",
        )
    dt = recording.dt
    speed = np.gradient(recording[angle], dt)
    names, columns = _columns(np.gradient(speed, dt), speed, _sign(recording[angle], dt), asymmetric)
    x = np.stack([_decimated(column, decimation) for column in columns])
    return names, x, _decimated(recording[torque], decimation), recording.time[::decimation][EDGE:-EDGE]


def _sign(angle: Floats, dt: float) -> Floats:
    from scipy.signal import butter, filtfilt

    b, a = butter(4, 2.0 * SIGN_CUTOFF)
    return np.asarray(np.sign(np.gradient(filtfilt(b, a, angle), dt)), dtype=float)


def _columns(
    acceleration: Floats, speed: Floats, sign: Floats, asymmetric: bool
) -> tuple[tuple[str, ...], list[Floats]]:
    names: tuple[str, ...]
    if not asymmetric:
        names = ("inertia", "viscous", "coulomb", "offset")
        return names, [acceleration, speed, sign, np.ones_like(speed)]
    plus, minus = 1.0 * (sign > 0.0), 1.0 * (sign < 0.0)
    names = ("inertia", "viscous_plus", "viscous_minus", "coulomb_plus", "coulomb_minus")
    return names, [acceleration, speed * plus, speed * minus, plus, -minus]


def _decimated(values: Floats, decimation: int) -> Floats:
    """Linear-phase FIR, every ``decimation``-th sample, without the edges that the filter bends."""
    from scipy.signal import decimate

    return np.asarray(decimate(values, decimation, ftype="fir")[EDGE:-EDGE], dtype=float)


@checks_arguments
def simulate_rigid_drive(
    found: FrictionFit, torque: Floats, dt: float, *, angle: float = 0.0, speed: float = 0.0
) -> Recording:
    """The drive as identified, under a torque held over each sample (Nm), exactly from event to event.

    Unlike ``simulate``, viscous friction may differ by direction, and the offset acts as a constant counter torque.

    Parameters
    ----------
    found : FrictionFit
        With an inertia.
    torque : (n,) array, Nm
    dt : float, s
    angle, speed : float, rad and rad/s
        At the start.

    Returns
    -------
    Recording
        ``torque_motor``, ``angle_motor``, ``speed_motor``; row k is the state before torque k acts.
    """
    from ...kernels.plant.rigid_drive import run_rigid_drive

    inertia = found.values.get("inertia")
    if inertia is None:
        raise InvalidInput("simulate_rigid_drive", "no inertia", "an identified or given one", "Give it.")
    coulomb, viscous, offset = found.levels()
    torque = np.array(torque, dtype=np.float64)
    out = run_rigid_drive(torque, dt, inertia, np.array(coulomb), np.array(viscous), offset, angle, speed)
    signals = {"torque_motor": torque, "angle_motor": out[:, 0], "speed_motor": out[:, 1]}
    return Recording(
        dt * np.arange(torque.size, dtype=np.float64), signals, dict.fromkeys(signals, "simulated")
    )


@checks_arguments
def output_error_fit(
    found: FrictionFit, recording: Recording, *, angle: str = "angle_motor"
) -> tuple[FrictionFit, Recording]:
    """The same parameters fitted to the angle that the torque alone would lead to, from rest at the first sample.

    Least squares of simulated minus measured angle, from the values found. The error integrates
    twice: a lower one on this recording may be a larger one on another, so check one.

    Returns
    -------
    (FrictionFit of the angle, its simulation)
    """
    from scipy.optimize import least_squares

    torque, measured, dt = recording[found.signal], recording[angle], recording.dt
    names = [n for n, s in found.sources.items() if s == "identified"]
    start = np.array([float(found.values[n] or 0.0) for n in names])
    scale = np.maximum(np.abs(start), 1e-3 * np.abs(start).max())

    def simulated(step: Floats) -> Recording:
        values = {**found.values, **dict(zip(names, (start + scale * step).tolist(), strict=True))}
        return simulate_rigid_drive(replace(found, values=values), torque, dt, angle=float(measured[0]))

    def residual(step: Floats) -> Floats:
        return simulated(step)["angle_motor"] - measured

    best: Any = least_squares(residual, np.zeros(len(names)), diff_step=[1e-5] * len(names))
    covariance = sandwich(np.ascontiguousarray(best.jac.T), np.asarray(best.fun))
    margins = student_factor(len(names)) * np.sqrt(np.diag(covariance)) * scale
    values, intervals, sources, problems = reported(
        tuple(names), start + scale * best.x, margins, _given_inertia(found), "output_error_fit"
    )
    run = simulated(best.x)
    return (
        FrictionFit(
            values=values,
            intervals=intervals,
            sources=sources,
            problems=(*found.problems, *problems),
            signal=angle,
            time=recording.time,
            torque=torque,
            measured=measured,
            fitted=run["angle_motor"],
            relative_error=float(np.linalg.norm(best.fun) / np.linalg.norm(measured)),
        ),
        run,
    )


def _given_inertia(found: FrictionFit) -> float | None:
    return found.values["inertia"] if found.sources.get("inertia") == "nameplate" else None
