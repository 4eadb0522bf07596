"""A law's step on bytes gives what the law gives, however much else is in memory."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.realtime.law_steps import own_step

LAWS = (
    lm.observers.kalman(PAPER, dt=1e-4),
    lm.controllers.pi(dt=1e-4, torque_limit=20.0),
    lm.observers.sliding_mode(PAPER, dt=1e-4),
)


@pytest.mark.parametrize("law", LAWS, ids=[law.name for law in LAWS])
def test_it_gives_the_bits_of_the_law(law: lm.DiscreteSystem | lm.Stepper) -> None:
    inputs = np.random.default_rng(1).normal(size=(200, len(law.inputs)))
    inputs[20, 0] = np.nan
    wanted = law.run(dict(zip(law.inputs, inputs.T, strict=True)))
    step, rubbish = own_step(law), []
    for k, row in enumerate(inputs):
        gc.collect(0)
        rubbish.append(np.full(len(law.outputs), np.pi))  # takes the place of what nobody keeps
        faults, made = step(row.tobytes())
        assert (faults != 0) == bool(wanted["input_fault"][k])
        assert np.frombuffer(made).tolist() == [wanted[name][k] for name in law.outputs]
