"""Further measured channels, an unknown load torque, and the contact law of the observer."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from lagged_drive import DT, PLANT, THETA

import lostmotion as lm
from lostmotion.identification import Identification
from lostmotion.identification.prediction_error.channel_innovations import ChannelPredictor
from lostmotion.identification.prediction_error.innovations import NAMES, Bandwidth, Predictor

GAIN = Bandwidth(300.0, 15.0)
NOISE = {"speed_motor": 0.02, "speed_load": 0.004, "twist": 4e-5, "torque_shaft": 0.3, "angle_motor": 2e-5}


@cache
def run(duration: float = 3.0) -> lm.Recording:
    torque = lm.signals.excitation(duration, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return lm.simulate(PLANT, torque_motor=torque, dt=DT)


@cache
def noisy() -> lm.Recording:
    rng = np.random.default_rng(7)
    n = len(run())
    return run().only("torque_motor").with_signals(
        "measured", **{name: run()[name] + level * rng.standard_normal(n) for name, level in NOISE.items()}
    )  # fmt: skip


@cache
def found(*further: str) -> Identification:
    """By the observer of constant gain: further channels have no second estimator."""
    start = PLANT.with_parameters(stiffness=5000.0)
    return lm.identify(noisy(), start=start, measured=("speed_motor", *further), second_estimator=False)


@pytest.mark.parametrize("averaged", [True, False])
@pytest.mark.parametrize("bounds", [(), (0, 4000, 10000)])
def test_motor_speed_alone_is_the_same_observer(averaged: bool, bounds: tuple[int, ...]):
    torque, speed = noisy()["torque_motor"][:10000].copy(), noisy()["speed_motor"][:10000].copy()
    usual = Predictor(torque, speed, DT, averaged, PLANT, 0, bounds, 500)
    wide = ChannelPredictor(
        torque, speed, DT, averaged, PLANT, 0, bounds, 500, averaged=("speed_motor",) if averaged else ()
    )
    expected = usual.residual(THETA, GAIN)
    assert np.max(np.abs(wide.residual(THETA, GAIN) - expected)) < 1e-7
    assert np.std(expected) > 0.01
    part = slice(3000, 6000)
    assert np.allclose(
        wide.part(part).residual(THETA, GAIN), usual.part(part).residual(THETA, GAIN), atol=1e-7
    )


@pytest.mark.parametrize("contact", ["viscoelastic", "dead_zone"])
@pytest.mark.parametrize("load_rate", [0.0, 20.0])
@pytest.mark.parametrize("further", [("speed_load", "torque_shaft"), ("twist", "angle_motor")])
def test_innovations_are_those_of_the_kalman_observer(
    contact: str, load_rate: float, further: tuple[str, ...]
):
    plant, n = PLANT.with_contact(contact).with_parameters(coulomb_motor=0.3), 3000
    measured = ("speed_motor", *further)
    values = {name: noisy()[name][:n].copy() for name in ("torque_motor", *measured)}
    wide = ChannelPredictor(
        values["torque_motor"], values["speed_motor"], DT, False, plant, 0,
        channels={name: values[name] for name in further}, levels=NOISE, load_rate=load_rate,
    )  # fmt: skip
    found = wide.residual(THETA, GAIN).reshape(n, -1)
    process = {"twist": 0.0, "speed_motor": GAIN.motor**2, "speed_load": GAIN.load**2}
    if load_rate:
        process["torque_load"] = (plant.inertia_total * load_rate**2) ** 2
    law = lm.observers.kalman(
        plant, dt=DT, measured=measured, process_covariance=process, load_torque=load_rate > 0.0,
        measurement_covariance={name: (NOISE[name] / NOISE["speed_motor"]) ** 2 for name in measured},
    )  # fmt: skip
    start = {name: values[name][0] for name in measured} | {"torque_actuator": values["torque_motor"][0]}
    start.setdefault("speed_load", start["speed_motor"])
    estimates = law.run(values, state=np.array([start.get(state, 0.0) for state in law.states]))
    for i, name in enumerate(measured):
        expected = (values[name] - estimates[f"{name}_estimated"]) * (NOISE["speed_motor"] / NOISE[name])
        np.testing.assert_allclose(found[:, i], expected, atol=1e-9 * np.max(np.abs(expected)) + 1e-9)


def test_levels_weigh_the_channels():
    channels = {name: noisy()[name].copy() for name in ("speed_load", "torque_shaft")}
    torque, speed = noisy()["torque_motor"].copy(), noisy()["speed_motor"].copy()
    wide = ChannelPredictor(torque, speed, DT, False, PLANT, 1000, channels=channels, levels=NOISE)
    residual = wide.residual(THETA, GAIN)
    assert residual.shape == (2 * len(noisy()) + len(noisy()),)
    assert not residual[: 3 * 1000].any() and residual[3 * 1000 :].all()
    assert wide.noise_levels(residual) == pytest.approx({n: NOISE[n] for n in wide.measured}, rel=0.1)
    assert np.std(residual[3001::3]) == pytest.approx(NOISE["speed_motor"], rel=0.1), (
        "in units of the motor speed"
    )


@pytest.mark.parametrize("further", [("speed_load",), ("twist", "torque_shaft"), ("angle_motor",)])
def test_every_channel_is_used_with_its_own_noise(further: tuple[str, ...]):
    result = found(*further)
    for name in further:
        assert result.prediction.levels[name] == pytest.approx(NOISE[name], rel=0.1)
    alone, more = found(), result
    # The statistical parts: only without further channels the shift by the sampling is taken off.
    assert alone.names == more.names == NAMES
    assert np.sum(np.diag(more.covariance) < 0.95**2 * np.diag(alone.covariance)) >= 3
    outside = [n for n in NAMES if not more.intervals[n][0] <= getattr(PLANT, n) <= more.intervals[n][1]]
    assert len(outside) <= 1


@pytest.mark.parametrize("seed", [1, 2])
def test_backlash_on_the_rig_with_the_load_speed(seed: int):
    recording, truth = lm.rig.record(seed)
    start = lm.Drivetrain.two_mass(**{n: truth.parameters[n] * 1.3 for n in NAMES})
    result = lm.identify(recording.window(0.0, 5.0), start=start, measured=("speed_motor", "speed_load"))
    assert result.values["backlash"] == pytest.approx(truth.parameters["backlash"], rel=0.015)


def test_slow_load_torque_is_told_from_friction():
    """A load torque that swings by ±1.5 Nm in 8 s; without a word about it the Coulomb torque is far off."""
    n = 50000
    drift = 1.5 * np.sin(2.0 * np.pi * np.arange(n) * DT / 8.0)
    torque = lm.signals.excitation(5.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    moved = lm.simulate(PLANT, torque_motor=torque, torque_load=drift, dt=DT)
    speed = moved["speed_motor"] + 0.02 * np.random.default_rng(3).standard_normal(n)
    recording = moved.only("torque_motor").with_signals("measured", speed_motor=speed)
    known, ignored = (
        lm.identify(
            recording, start=PLANT, load_torque=given, speed_from_counts=False, second_estimator=False
        )
        for given in (True, False)
    )
    for name, most in (("coulomb", 0.05), ("inertia_load", 0.01), ("backlash", 0.005)):
        assert known.values[name] == pytest.approx(getattr(PLANT, name), rel=most), name
    assert known.prediction.levels["speed_motor"] < 0.03 < 0.04 < ignored.prediction.levels["speed_motor"]


def test_misuse_is_told():
    with pytest.raises(lm.InvalidInput, match=r"identify\.measured"):
        lm.identify(noisy(), start=PLANT, measured=("speed_load",))
    with pytest.raises(lm.InvalidInput, match=r"identify\.measured"):
        lm.identify(noisy(), start=PLANT, measured=("speed_motor", "torque_load"))
    with pytest.raises(lm.InvalidInput, match="speed_load"):
        lm.identify(
            noisy().only("torque_motor", "speed_motor"), start=PLANT, measured=("speed_motor", "speed_load")
        )
    with pytest.raises(lm.InvalidInput, match=r"identify\.contact"):
        lm.identify(noisy(), start=PLANT, contact="clipped")
