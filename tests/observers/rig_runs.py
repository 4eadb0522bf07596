"""Runs on the virtual rig, and how estimates are judged there, for the tests of the steppers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lostmotion import rig
from lostmotion.drivetrain import Drivetrain
from lostmotion.recording import Recording
from lostmotion.signals import excitation


class Experiment(NamedTuple):
    recording: Recording  # what the sensors show
    exact: Recording  # the true signals
    drivetrain: Drivetrain  # the equivalent two-mass model


def rig_experiment(seed: int, duration: float) -> Experiment:
    torque = excitation(duration, 1e-4, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    recording, truth = rig.record(seed, torque_motor=torque)
    model = Drivetrain.two_mass(**truth.parameters, torque_limit=rig.TORQUE_LIMIT)
    return Experiment(recording, truth.signals, model)


def relative_rmse(estimate: Recording, exact: Recording, signal: str, start: int = 5000) -> float:
    """RMSE over the range of the true signal, from row ``start`` on."""
    truth = exact[signal][start:]
    error = estimate[f"{signal}_estimated"][start:] - truth
    return float(np.sqrt(np.mean(error**2)) / np.ptp(truth))


def gap_f1(in_gap: np.ndarray, exact: Recording, backlash: float, start: int = 5000) -> float:
    """F1 of the samples in the gap; the rig's gap is in its third shaft."""
    truth = np.abs(exact["twist_3"][start:]) < 0.5 * backlash
    told = in_gap[start:]
    return float(2.0 * np.sum(truth & told) / (np.sum(truth) + np.sum(told)))
