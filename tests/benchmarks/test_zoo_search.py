"""The benchmark of the search takes the whole true chain for the start of its descent."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.structures.softest_shaft import Chain
from lostmotion.identification.prediction_error.innovations import Predictor

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import zoo_search

DT = 1e-3


@pytest.mark.parametrize("gap", [0, 1, 2])
def test_the_true_chain_comes_out_of_its_values(gap: int):
    """Four inertias with the gap in any shaft, as the filter's parameters and back."""
    inertias = (0.05, 0.02, 0.01, 0.08)
    shafts = [lm.Shaft(2e4, 12.0), lm.Shaft(1.5e4, 3.0), lm.Shaft(6e3, 1.0)]
    shafts[gap] = replace(shafts[gap], backlash=0.01)
    chain = lm.Drivetrain(inertias, tuple(shafts), (lm.Friction(),) * 3 + (lm.Friction(1.0),))
    drive = SimpleNamespace(truth=SimpleNamespace(drivetrain=chain, parameters={"lag": 0.0}))
    values, third, fourth = zoo_search.true_values(drive, DT)
    generator = np.random.default_rng(1)
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.05, inertia_load=0.08, stiffness=6e3, damping=1.0, backlash=0.01
    )
    signals = generator.standard_normal((2, 400))
    flt = ContactFilter.of(Predictor(signals[0], signals[1], DT, False, plant, skip=0), 100.0)
    flt = replace(flt, behind=third, fourth_behind=fourth)
    found = Chain.of(Candidate("true chain", flt.theta(values), np.inf, flt, []))
    assert found is not None and found.joint == gap
    compliances = np.array([1.0 / shaft.stiffness for shaft in shafts])
    losses = np.array([shaft.damping / shaft.stiffness for shaft in shafts])
    np.testing.assert_allclose(found.inertias, inertias)
    np.testing.assert_allclose(found.compliances, compliances / compliances.sum())
    np.testing.assert_allclose(found.losses, losses / losses[gap])
    assert values["backlash"] == 0.01 and values["coulomb"] == 1.0
    assert values["lag"] + values["delay"] == 0.0
