"""Claims of sections III and V: observability, and the gains that follow from the printed matrices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...controllers.pole_placement import StateFeedback, state_feedback
from ...drivetrain import Drivetrain
from ...observers.fixed_gain.kalman import kalman_gain
from .. import published
from ..claim import Claim, judged, signed
from ..experiments import Experiments

Floats = NDArray[np.float64]

#: Largest condition number of the observability matrix in units that fit the drive (option: above, a digit of the
#: measurement in a thousand decides about a state).
CONDITION = 1e3
TO_ALL_DIGITS = "every digit of the number that was recomputed by hand"


def claims(_: Experiments) -> list[Claim]:
    table = published.paper_drivetrain(coulomb=0.0, viscous=0.0)
    feedback = state_feedback(table, (published.POLE_PLACED,) * 3)
    return [
        observable("C₁", table, output_matrix(table, ("speed_motor",))),
        observable("C₂", table, output_matrix(table, ("torque_shaft", "speed_motor"))),
        observer_gain("L₁", table, published.PROCESS_COVARIANCE, published.R_1, published.L_1),
        observer_gain("L₂", table, published.PROCESS_COVARIANCE, published.R_2, published.L_2),
        state_gain(feedback),
        prefilter(feedback),
        friction_gain(feedback),
    ]


def output_matrix(drivetrain: Drivetrain, measured: Sequence[str]) -> Floats:
    """C of equations (4) and (5) over (twist, speed_motor, speed_load)."""
    k, d = drivetrain.stiffness, drivetrain.damping
    rows = {"torque_shaft": [k, d, -d], "speed_motor": [0.0, 1.0, 0.0], "speed_load": [0.0, 0.0, 1.0]}
    return np.array([rows[signal] for signal in measured])


def observable(name: str, drivetrain: Drivetrain, c: Floats) -> Claim:
    """Rank and condition of [C; CA; CA²], in units of the drive.

    Units: the torsional frequency ω for time, 1/ω rad for the twist, and each measured signal by its own row: else the
    condition number would be that of rad, Nm and seconds.
    """
    a, _ = drivetrain.linear()
    omega = 2.0 * np.pi * drivetrain.pole_frequency
    to_units = np.diag([1.0 / omega, 1.0, 1.0])
    scaled = np.linalg.inv(to_units) @ a @ to_units / omega
    rows = c @ to_units
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    matrix = np.vstack([rows @ np.linalg.matrix_power(scaled, i) for i in range(3)])
    rank, condition = int(np.linalg.matrix_rank(matrix)), float(np.linalg.cond(matrix))
    return Claim(
        name=f"observable with {name}",
        says=f"The linear system has full observability for the matrix {name}.",
        where="section III",
        quantity="rank and condition number of the observability matrix",
        value=(float(rank), condition),
        tolerance=f"rank 3, condition number at most {CONDITION:g}",
        verdict=judged(rank == 3, condition <= CONDITION) if rank == 3 else "does not hold",
        sentence=f"Rank {rank}, condition number {condition:.3g} in units of the drive. This is the closed "
        "shaft: inside the gap no sensor on the motor's side shows the twist.",
    )


def observer_gain(
    name: str,
    drivetrain: Drivetrain,
    process: Mapping[str, float],
    measurement: Mapping[str, float],
    printed: Sequence[Sequence[str]],
) -> Claim:
    """The gain of the continuous Riccati equation (6) from the covariances (8)."""
    gain = kalman_gain(
        drivetrain, tuple(measurement), process_covariance=process, measurement_covariance=measurement
    )
    found = [
        _same(g, p) for row, texts in zip(gain, printed, strict=True) for g, p in zip(row, texts, strict=True)
    ]
    matrix = "; ".join(", ".join(_written(g, p) for g, p in zip(row, texts, strict=True))
                       for row, texts in zip(gain, printed, strict=True))  # fmt: skip
    return Claim(
        name=f"gain {name}",
        says=f"{name} follows from the Riccati equation with the covariances of equation (8).",
        where="section III, equations (6) and (8)",
        quantity=f"{name}, rows: twist, motor speed, load speed",
        value=tuple(map(float, gain.ravel())),
        tolerance=TO_ALL_DIGITS,
        verdict=judged(*found),
        sentence=f"{name} = [{matrix}]. The paper prints the covariances, not the gain.",
    )


def state_gain(feedback: StateFeedback) -> Claim:
    """K by Ackermann's formula."""
    says = "All three poles at −400 1/s determine K."
    return _feedback("gain K", "K", "Nm/rad, Nm s/rad, Nm s/rad", says, feedback.gain, published.K)


def prefilter(feedback: StateFeedback) -> Claim:
    """V, which makes the load speed the set-point in steady state."""
    says = "The static prefilter V gives steady-state accuracy."
    return _feedback("prefilter V", "V", "Nm s/rad", says, [feedback.prefilter], (published.V,))


def friction_gain(feedback: StateFeedback) -> Claim:
    """Motor torque for each Nm of friction on the load."""
    says = "The static prefilter DC adds a motor torque equivalent to the Coulomb friction."
    return _feedback(
        "friction gain of DC", "Gain of DC", "1", says, [feedback.friction_gain], (published.FRICTION_GAIN,)
    )


def _feedback(
    name: str, symbol: str, unit: str, says: str, values: Sequence[float] | Floats, printed: Sequence[str]
) -> Claim:
    shown = ", ".join(_written(v, p) for v, p in zip(values, printed, strict=True))
    return Claim(
        name=name,
        says=says,
        where="section V",
        quantity=f"{symbol}, {unit}",
        value=tuple(map(float, values)),
        tolerance=TO_ALL_DIGITS,
        verdict=judged(*(_same(v, p) for v, p in zip(values, printed, strict=True))),
        sentence=f"{symbol} = {shown}. The paper prints the poles, not this number.",
    )


def _written(value: float, printed: str) -> str:
    """With as many decimals as another number."""
    return signed(float(value), f".{len(printed.partition('.')[2])}f")


def _same(value: float, printed: str) -> bool:
    return _written(value, printed) == printed.replace("-", "−")
