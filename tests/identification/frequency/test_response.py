"""Frequency response: right values, honest bands, no bias by sampling or by feedback; the two-mass fit."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from table_i import LINEAR

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.identification.frequency.response import frequency_response
from lostmotion.identification.frequency.two_mass_fit import two_mass_fit
from lostmotion.identification.frequency.two_mass_response import OUTPUTS, two_mass_response
from lostmotion.recording import Recording

PLANT = lm.Drivetrain.two_mass(**LINEAR)
NOISE = {"speed": 0.1, "angle": 1e-4, "torque": 0.5, "twist": 1e-4}


@lru_cache
def recording(seed=1, dt=1e-3, duration=60.0, noise=1.0):
    torque = lm.signals.noise(1.0, 300.0, 5.0, duration, dt, seed=seed)
    signals = lm.simulate(PLANT, dt=dt, torque_motor=torque)
    rng = np.random.default_rng(seed)
    noisy = {
        name: signals[name] + noise * NOISE[name.split("_")[0]] * rng.standard_normal(len(signals))
        for name in OUTPUTS
    }
    return signals.with_signals("measured", **noisy)


def truth(found):
    how = found.sampling
    return how.fold(lambda s: two_mass_response(LINEAR, how.source, s), found.frequency)


@pytest.mark.parametrize("output", OUTPUTS)
def test_every_output_and_its_bands(output):
    found = frequency_response(recording(), output=output, segment=5.0)
    used = found.band(3.0, 280.0)
    error = (found.response - truth(found))[used]
    inside = np.mean(np.abs([error.real, error.imag]) < found.margin[used])
    assert 0.92 < inside < 0.995
    assert np.median(np.abs(error / truth(found)[used])) < 0.3


def test_variance_is_the_scatter_of_repetitions():
    several = [
        frequency_response(recording(seed, duration=20.0), segment=2.0, band=(5.0, 200.0))
        for seed in range(30)
    ]
    responses = np.array([r.response - truth(r) for r in several])
    scatter = np.mean(np.abs(responses) ** 2, axis=0)
    claimed = np.mean([r.variance for r in several], axis=0)
    assert np.median(scatter / claimed) == pytest.approx(1.0, abs=0.15)


def test_angle_from_the_angle_itself_agrees_with_that_from_speed():
    whole = recording(noise=0.0)
    by_speed = frequency_response(whole, segment=5.0, band=(3.0, 100.0))
    by_angle = frequency_response(whole.only("torque_motor", "angle_motor"), segment=5.0, band=(3.0, 100.0))
    assert (by_speed.sampling.source, by_angle.sampling.source) == ("speed_motor", "angle_motor")
    for found in (by_speed, by_angle):
        assert np.median(np.abs(found.response / truth(found) - 1.0)) < 0.01


def test_counted_speed_is_a_mean_over_the_sample():
    whole = recording(noise=0.0)
    counted = np.diff(whole["angle_motor"], prepend=whole["angle_motor"][0]) / whole.dt
    mean = Recording(
        whole.time,
        {"torque_motor": whole["torque_motor"], "speed_motor": counted},
        meta={"speed_from_counts": True},
    )
    found = frequency_response(mean, segment=5.0, band=(3.0, 280.0))
    away = np.abs(found.frequency - 38.0) > 3.0
    assert np.max(np.abs(found.response / truth(found) - 1.0)[away]) < 0.05
    # Up here a quarter of the sample rate is near, and the images of a mean fall faster than those of a value.
    high = found.band(220.0, 280.0)
    assert np.max(np.abs(found.response / truth(found) - 1.0)[high]) < 0.01


def test_images_of_a_held_input_are_part_of_the_model():
    found = frequency_response(recording(noise=0.0), segment=10.0, band=(180.0, 250.0))
    continuous = two_mass_response(LINEAR, "angle_motor", 2j * np.pi * found.frequency)
    assert np.max(np.abs(found.response / truth(found) - 1.0)) < 0.01
    assert np.min(np.abs(found.response / continuous - 1.0)) > 0.05


def test_methods_are_right_for_noise_in_output_or_input():
    rng = np.random.default_rng(4)
    x = rng.standard_normal(40_000)
    y = 2.0 * x

    def gain(noise_x, noise_y, method):
        signals = {
            "a": x + noise_x * rng.standard_normal(x.size),
            "b": y + noise_y * rng.standard_normal(x.size),
        }
        found = frequency_response(
            Recording(np.arange(x.size) * 1e-3, signals), "a", "b", method, segment=0.5
        )
        return float(np.mean(found.magnitude))

    assert gain(0.0, 2.0, "H1") == pytest.approx(2.0, rel=0.02)
    assert gain(1.0, 0.0, "H2") == pytest.approx(2.0, rel=0.02)
    assert gain(1.0, 0.0, "H1") == pytest.approx(1.0, rel=0.05)
    assert gain(0.5, 1.0, "Hv") == pytest.approx(2.0, rel=0.02)


def test_closed_loop_needs_the_reference():
    """y = x + v, x = r − 0.9·(y one sample ago): feedback drags H1 from 1 towards −1/controller."""
    rng = np.random.default_rng(5)
    n = 40_000
    r, v = rng.standard_normal(n), 2.0 * rng.standard_normal(n)
    x, y = np.zeros(n), np.zeros(n)
    for k in range(n):
        x[k] = r[k] - 0.9 * (y[k - 1] if k else 0.0)
        y[k] = 0.5 * x[k - 1] + v[k] if k else v[k]
    loop = Recording(np.arange(n) * 1e-3, {"x": x, "y": y, "speed_reference": r})
    arguments = {"input": "x", "output": "y", "segment": 0.25, "band": (20.0, 400.0)}
    direct = frequency_response(loop, **arguments)
    joint = frequency_response(loop, reference="speed_reference", **arguments)
    true = 0.5 * np.exp(-2j * np.pi * joint.frequency * 1e-3)
    assert np.median(np.abs(direct.response - true)) > 0.3
    error = joint.response - true
    assert np.median(np.abs(error)) < 0.1
    assert 0.90 < np.mean(np.abs([error.real, error.imag]) < joint.margin) < 0.99
    assert any("reference" in p.remedy for p in direct.problems)
    assert joint.problems == ()
    assert joint.method == "joint"


def test_speed_control_under_load_torque():
    """A PI loop passes the load's torque on to the motor: directly the zero seems far too high, jointly right."""
    dt, duration = 5e-4, 40.0
    signals = lm.simulate(
        PLANT,
        dt=dt,
        law=lm.controllers.pi(kp=5.0, ki=100.0, dt=dt, torque_limit=200.0),
        speed_reference=lm.signals.noise(0.5, 200.0, 2.0, duration, dt, seed=1),
        torque_load=lm.signals.noise(0.5, 200.0, 30.0, duration, dt, seed=2),
    )
    direct = two_mass_fit(frequency_response(signals, segment=2.5, band=(3.0, 180.0)))
    found = frequency_response(signals, segment=2.5, band=(3.0, 180.0), reference="speed_reference")
    joint, error = two_mass_fit(found), found.response - truth(found)
    assert 0.90 < np.mean(np.abs([error.real, error.imag]) < found.margin) < 0.98
    assert direct.values["zero"] > 45.0
    for name in ("zero", "pole"):
        low, high = joint.intervals[name]
        assert low < getattr(PLANT, f"{name}_frequency") < high
        assert high / low < 1.25


def test_coherence_is_low_at_the_zero():
    found = frequency_response(recording(noise=2.0), segment=5.0)
    at_zero = found.coherence[found.band(37.5, 38.3)]
    elsewhere = found.coherence[found.band(60.0, 110.0)]
    assert at_zero.min() < 0.2 < 0.95 < np.median(elsewhere)
    assert found.coherence_by_chance == pytest.approx(1.0 - 0.05 ** (1.0 / (found.averages - 1.0)))


@pytest.mark.parametrize("output", ["angle_motor", "torque_shaft", "speed_load", "twist"])
def test_two_mass_fit(output):
    hits, errors = [], []
    start = None if output == "angle_motor" else PLANT
    for seed in range(3):
        fit = two_mass_fit(
            frequency_response(recording(seed, noise=2.0), output=output, segment=6.0),
            band=(3.0, 280.0),
            start=start,
        )
        true = {**LINEAR, "zero": PLANT.zero_frequency, "pole": PLANT.pole_frequency, "delay": 0.0}
        known = [name for name in true if name in fit.intervals]
        hits += [fit.intervals[name][0] <= true[name] <= fit.intervals[name][1] for name in known]
        errors.append(
            [fit.values[name] / true[name] - 1.0 for name in ("inertia_load", "stiffness", "zero", "pole")]
        )
        assert fit.problems == ()
    assert np.mean(hits) > 0.8
    assert np.max(np.abs(errors)) < 0.05


def test_fit_finds_a_delay_and_ignores_a_foreign_line():
    clean = recording(noise=1.0)
    wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * clean.time)
    late = np.roll(clean["speed_motor"], 2)
    found = frequency_response(clean.with_signals("measured", speed_motor=late + wave), segment=6.0)
    fit = two_mass_fit(found, band=(3.0, 280.0))
    assert fit.values["delay"] == pytest.approx(2e-3, rel=0.02)
    assert fit.values["zero"] == pytest.approx(PLANT.zero_frequency, rel=0.01)
    assert fit.values["stiffness"] == pytest.approx(6285.896, rel=0.02)


def test_fit_forgives_some_wrong_lines():
    """A foreign mode: twenty of 1600 lines ten times too large, with a coherence that does not give them away."""
    found = frequency_response(recording(), segment=6.0)
    wrong = found.band(60.0, 63.2)
    bad = replace(found, response=np.where(wrong, 10.0 * found.response, found.response))
    fit = two_mass_fit(bad, band=(3.0, 280.0))
    assert wrong.sum() == 20
    for name in ("stiffness", "inertia_load", "zero", "pole"):
        true = {**LINEAR, "zero": PLANT.zero_frequency, "pole": PLANT.pole_frequency}[name]
        assert fit.values[name] == pytest.approx(true, rel=0.01)


def test_fit_says_where_the_band_or_the_resolution_is_too_small():
    found = frequency_response(recording(), segment=1.0)
    assert any("damping" in p.where for p in two_mass_fit(found, band=(3.0, 280.0)).problems)
    narrow = two_mass_fit(frequency_response(recording(), segment=6.0), band=(3.0, 80.0))
    assert any("pole" in p.where for p in narrow.problems) or narrow.values["pole"] < 80.0


def test_results_are_ready_for_json():
    found = frequency_response(recording(), segment=6.0, band=(3.0, 280.0))
    data = json.loads(json.dumps({**found.as_dict(), "fit": two_mass_fit(found).as_dict()}, allow_nan=False))
    assert len(data["real"]) == len(data["frequency_hz"]) == found.frequency.size
    assert set(data["fit"]["intervals"]) >= {"zero", "pole", "stiffness"}


@pytest.mark.parametrize(
    "arguments",
    [
        {"method": "H3"},
        {"output": "nothing"},
        {"segment": 40.0},
        {"band": (600.0, 700.0)},
    ],
)
def test_misuse_is_refused(arguments):
    with pytest.raises(InvalidInput):
        frequency_response(recording(duration=5.0), **arguments)


def test_without_a_band_the_coherent_lines_are_fitted():
    """At 10 kHz most lines hold nothing but sensor noise; the search must not follow them."""
    torque = lm.signals.noise(2.0, 140.0, 5.0, 20.0, 1e-4, seed=3)
    exact = lm.simulate(PLANT, dt=1e-4, torque_motor=torque)
    noise = 0.05 * np.random.default_rng(3).standard_normal(len(exact))
    noisy = exact.with_signals("measured", speed_motor=exact["speed_motor"] + noise)
    fit = two_mass_fit(frequency_response(noisy))
    assert 130.0 < fit.frequency[-1] < 170.0
    assert fit.values["zero"] == pytest.approx(PLANT.zero_frequency, rel=0.02)
    assert fit.values["pole"] == pytest.approx(PLANT.pole_frequency, rel=0.02)
    unrelated = noisy.with_signals("measured", speed_motor=noise)
    with pytest.raises(InvalidInput, match="coherence"):
        two_mass_fit(frequency_response(unrelated))


def test_missing_samples_and_too_few_segments_are_said():
    whole = recording(duration=5.0)
    keep = (whole.time < 2.0) | (whole.time > 2.01)
    holed = Recording(whole.time[keep], {name: whole[name][keep] for name in ("torque_motor", "speed_motor")})
    assert "missing" in frequency_response(holed, segment=0.5).problems[0].remedy
    assert "segments" in frequency_response(whole, segment=2.0).problems[0].got
    assert frequency_response(whole, segment=0.5).problems == ()


def test_what_a_response_does_not_tell_must_be_given():
    with pytest.raises(InvalidInput, match="inertia_motor"):
        two_mass_fit(frequency_response(recording(duration=5.0), output="torque_shaft"))
    with pytest.raises(InvalidInput, match="torque_motor"):
        two_mass_fit(frequency_response(recording(duration=5.0), "speed_load", "speed_motor"))


def repeated(period=2.0, periods=8, noise=1.0, seed=1):
    """Table I's linear drivetrain under a multisine that repeats, with noise in torque and speed."""
    dt = 1e-3
    torque = np.tile(lm.signals.multisine(3.0, 280.0, 5.0, period, dt, seed=seed), periods)
    run = lm.simulate(PLANT, dt=dt, torque_motor=torque)
    rng = np.random.default_rng(seed)
    measured = {
        name: run[name] + noise * NOISE[name.split("_")[0]] * rng.standard_normal(len(run))
        for name in ("torque_motor", "speed_motor")
    }
    return run.with_signals("measured", **measured)


def test_periods_are_averaged_without_bias():
    """Noise in the input biases H1 at every length; averages over periods have none, and no leakage either."""
    found = frequency_response(repeated(), output="speed_motor", period=2.0)
    assert found.segments == 7 and found.method == "periods"
    assert np.mean(found.band(3.0, 280.0)) > 0.99  # what is not excited is left out
    error = (found.response - truth(found))[found.band(3.0, 280.0)]
    inside = np.mean(np.abs([error.real, error.imag]) < found.margin[found.band(3.0, 280.0)])
    assert 0.9 < inside < 0.99
    exact, windowed = (
        frequency_response(repeated(noise=0.0), output="speed_motor", band=(3.0, 120.0), **how)
        for how in ({"period": 2.0}, {"segment": 2.0})
    )
    averaged, leaked = (np.median(np.abs(one.response / truth(one) - 1.0)) for one in (exact, windowed))
    assert (
        averaged < 1e-3 and leaked > 5e-3
    )  # the rest: images of the held torque, which ``truth`` has in part


def test_a_period_that_does_not_repeat_is_refused():
    with pytest.raises(InvalidInput, match="whole number of samples"):
        frequency_response(repeated(), period=2.0004)
    with pytest.raises(InvalidInput, match="three periods"):
        frequency_response(repeated(), period=6.0)
    with pytest.raises(InvalidInput, match="beside a segment"):
        frequency_response(repeated(), period=2.0, segment=1.0)


RIGID = lm.Drivetrain(inertias=(0.1292,), frictions=(lm.Friction(viscous=0.0175),))


def noisy_response(plant, noise, seed):
    """Of the motor speed, with noise in its standard deviations."""
    torque = lm.signals.noise(1.0, 200.0, 5.0, 20.0, 1e-3, seed=seed)
    run = lm.simulate(plant, torque_motor=torque, dt=1e-3)
    error = noise * np.std(run["speed_motor"]) * np.random.default_rng(seed).standard_normal(len(run))
    measured = run.with_signals("measured", speed_motor=run["speed_motor"] + error)
    return frequency_response(measured, output="speed_motor", segment=2.0)


@pytest.mark.parametrize(
    ("noise", "seed", "band"),
    [(0.0, 1, (2.0, 180.0)), (0.01, 2, None), (0.01, 9, None), (0.1, 1, None), (1.0, 5, None)],
)
def test_a_rigid_drive_has_no_stiffness(noise, seed, band):
    """It was a stiffness of 2e-12 Nm/rad ± 0.01 %, and with noise one of 0.5 Nm/rad or more, in half of all cases."""
    found = two_mass_fit(noisy_response(RIGID, noise, seed), band=band)
    assert {found.values[name] for name in ("stiffness", "inertia_load", "damping", "zero", "pole")} == {None}
    assert found.values["inertia_total"] == pytest.approx(0.1292, rel=0.02)
    low, high = found.intervals["inertia_total"]
    # With little noise the window's leakage at 1 Hz counts more.
    assert noise == 0.01 or low <= 0.1292 <= high
    # Without noise a mode below the band fits the leakage.
    assert noise == 0.0 or len(found.drivetrain.inertias) == 1
    assert any("not identified" in problem.remedy for problem in found.problems)


def test_a_mode_is_told_where_noise_does_not_make_it():
    """Under noise as large as the speed itself."""
    found = two_mass_fit(noisy_response(PLANT, 1.0, 1))
    low, high = found.intervals["stiffness"]
    assert low <= LINEAR["stiffness"] <= high and high / low < 1.5


def test_what_may_be_anything_is_not_identified(monkeypatch: pytest.MonkeyPatch):
    """An interval beyond all numbers stopped the fit with an overflow."""
    found = frequency_response(recording(), segment=5.0)
    shown = two_mass_fit(found)

    def hopeless(*_):
        return np.diag([1.0, 1e6, 1e-6, 1e-6, 1e-6, 1e-6])

    monkeypatch.setattr("lostmotion.identification.frequency.two_mass_fit.covariance_of", hopeless)
    fit = two_mass_fit(found)
    assert fit.values["inertia_load"] is None and "inertia_load" not in fit.intervals
    assert fit.values["stiffness"] == shown.values["stiffness"] and "stiffness" in fit.intervals
    json.dumps(fit.as_dict(), allow_nan=False)
