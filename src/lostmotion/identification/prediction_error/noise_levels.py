"""Fit with further channels or an unknown load torque, from the fit to motor torque and motor speed alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .channel_innovations import ChannelPredictor
from .gain_schedule import Box, Stage, descent, fit

Array = NDArray[np.float64]

#: Rates at which an unknown load torque is followed, 1/s (calibrated on the virtual rigs 1 and 2 with 1.5 Nm at 0.3 Hz,
#: ``benchmarks/calibrations.py``: median error 0.8, 0.6 and 1.9 % with half, all and double of them). The slowest is
#: taken that predicts not much worse than the best: a faster one also takes away what is friction.
LOAD_RATES = (10.0, 30.0)

#: Largest ratio of innovations to the best ones that counts as not much worse (calibrated likewise: median error 1.7,
#: 0.6 and 0.6 % with 1.1, 1.2 and 1.4).
MUCH_WORSE = 1.2

#: Fits in turn with estimates of the noise levels at most, and when the levels count as settled (numerics).
ROUNDS, SETTLED = 6, 0.02

#: Level of a channel that the observer does not listen to, in standard deviations of its signal (numerics).
DEAF = 1e4


def refine(
    predictor: ChannelPredictor, theta: Array, stage: Stage, box: Box, load_torque: bool
) -> tuple[ChannelPredictor, Stage]:
    """Fit and noise levels in turn, from the fit to motor torque and motor speed.

    With an unknown load torque that stage is biased: the gain is lowered anew from the start theta, for each rate.
    """
    if not load_torque:
        return _settled(predictor, stage, box)
    tried = []
    for rate in LOAD_RATES:
        following = replace(predictor, load_rate=rate)
        tried.append(_settled(following, descent(following, theta, stage.free, box, _silent, fit)[-1], box))
    # With normal innovations of the levels σ, the likelihood falls with the sum of log σ over the channels.
    scores = [float(np.sum(np.log(list(found.levels.values())))) for found, _ in tried]
    return next(t for t, score in zip(tried, scores, strict=True) if score < min(scores) + np.log(MUCH_WORSE))


def _silent(fraction: float, text: str) -> None:
    """The progress of a search within a stage is not shown."""


def _settled(predictor: ChannelPredictor, stage: Stage, box: Box) -> tuple[ChannelPredictor, Stage]:
    # A descent with all channels would weigh them by wrong levels: first listen to the motor speed alone.
    deaf = {name: DEAF * float(np.std(values)) for name, values in predictor.channels.items()}
    predictor = replace(predictor, levels={"speed_motor": 1.0, **deaf})
    residual = predictor.residual(stage.fit.theta, stage.bandwidth)
    predictor = replace(predictor, levels=predictor.noise_levels(residual))
    for _ in range(ROUNDS):
        found = fit(predictor, stage.fit.theta, stage.free, box, stage.bandwidth)
        stage = replace(stage, fit=found, iterations=stage.iterations + found.iterations)
        levels = predictor.noise_levels(found.residual)
        moved = max(abs(np.log(levels[name] / predictor.levels[name])) for name in levels)
        if moved < SETTLED:
            break
        predictor = replace(predictor, levels=levels)
        residual = predictor.residual(found.theta, stage.bandwidth)
        cost = float(np.sum(residual**2))
        stage = replace(stage, fit=replace(found, residual=residual, cost=cost))
    return predictor, stage
