"""A sound call of every public function that takes arguments, cheap enough to be made a dozen times."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from table_i import PAPER

import lostmotion as lm
from lostmotion import (
    certificates,
    controllers,
    identification,
    metrics,
    observers,
    plot,
    rig,
    signals,
    structure,
    systems,
)
from lostmotion import io as files
from lostmotion.curves import dead_zone, saturation
from lostmotion.events import NO_EVENTS

DT, ROWS = 1e-3, 400


class Call(NamedTuple):
    """A public function and arguments that it takes."""

    function: Callable[..., Any]
    arguments: dict[str, Any]


#: Arguments of a frequency response.
RESPONSE: dict[str, Any] = {
    "input": "torque_motor", "output": "speed_motor", "method": "H1", "segment": 0.1, "band": (10.0, 200.0),
}  # fmt: skip


@functools.cache
def plant() -> lm.Drivetrain:
    return PAPER


@functools.cache
def recording() -> lm.Recording:
    time = DT * np.arange(ROWS)
    torque = np.random.default_rng(1).normal(size=ROWS)
    names = ("speed_motor", "speed_load", "angle_motor", "angle_load", "torque_shaft", "speed_reference")
    moved = {name: np.cumsum(torque) * 0.01 * (1 + 0.1 * i) for i, name in enumerate(names)}
    return lm.Recording(time, {"torque_motor": torque, **moved})


@functools.cache
def law() -> lm.DiscreteSystem:
    return controllers.pi(dt=DT, kp=1.0, ki=2.0, torque_limit=5.0)


@functools.cache
def linear() -> lm.DiscreteSystem:
    """A law without curves."""
    return lm.DiscreteSystem(inputs=("speed_motor",), outputs=("torque_motor",), dt=DT, D=[[-1.0]])


@functools.cache
def model() -> structure.TorsionalModel:
    stiffness = [[5e3, -5e3, 0.0], [-5e3, 1.4e4, -9e3], [0.0, -9e3, 9e3]]
    return structure.TorsionalModel(np.diag([0.01, 0.02, 0.1]), np.array(stiffness))


def _drives() -> list[Call]:
    two_mass = {
        "inertia_motor": 0.02,
        "inertia_load": 0.1,
        "stiffness": 6e3,
        "damping": 0.4,
        "backlash": 0.01,
    }
    return [
        Call(lm.Drivetrain.two_mass, two_mass | {"coulomb": 2.0, "viscous": 0.1, "lag": 1e-3}),
        Call(lm.Drivetrain, {"inertias": (0.1, 0.2), "shafts": (lm.Shaft(1e3),), "locked": "load"}),
        Call(lm.Shaft, {"stiffness": 1e3, "damping": 0.1, "backlash": 0.01, "contact": "dead_zone"}),
        Call(
            lm.Friction,
            {"coulomb": 1.0, "viscous": 0.1, "breakaway": 2.0, "stribeck": ((0.0, 0.5), (0.1, 0.0))},
        ),
        Call(lm.Actuator, {"lag": 1e-3, "torque_limit": 5.0, "rate_limit": 1e3}),
        Call(lm.Gear, {"ratio": 2.0}),
        Call(lm.PiecewiseLinear, {"points": ((0.0, 0.0), (1.0, 1.0)), "slope_left": 0.1, "slope_right": 0.1}),
        Call(dead_zone, {"half_width": 0.1, "slope": 2.0}),
        Call(saturation, {"limit": 0.1, "slope": 2.0}),
    ]


def _signals() -> list[Call]:
    span = {"duration": 0.5, "dt": DT}
    band = {"low": 10.0, "high": 100.0, "rms": 1.0, **span, "seed": 1}
    inertia = {
        "inertia": 0.1,
        "coulomb": 1.0,
        "viscous": 0.1,
        "levels": (1.0, -1.0),
        "ramp": 0.1,
        "noise_rms": 1.0,
    }
    return [
        Call(signals.steps, {"times": (0.1,), "values": (0.0, 1.0), **span}),
        Call(signals.chirp, {"low": 1.0, "high": 9.0, "amplitude": 1.0, **span}),
        Call(signals.multisine, band),
        Call(signals.noise, band),
        Call(signals.prbs, {"amplitude": 1.0, "shortest": 0.01, **span, "seed": 1}),
        Call(signals.excitation, {**span, "seed": 1, **inertia, "band": (2.0, 140.0), "limit": 9.0}),
    ]


def _metrics() -> list[Call]:
    time, step = recording().time, np.linspace(0.0, 1.0, ROWS)
    change = {"step_time": 0.1, "before": 0.0, "after": 1.0, "stop_time": 0.3}
    return [
        Call(metrics.compare, {"estimate": step, "truth": step + 0.1, "dt": DT}),
        Call(metrics.lag, {"estimate": step, "truth": step + 0.1, "dt": DT, "max_lag": 0.01}),
        Call(metrics.largest_error, {"a": step, "b": step}),
        Call(metrics.rmse, {"a": step, "b": step}),
        Call(metrics.signal_range, {"a": step}),
        Call(metrics.recovery, {"time": time, "error": step, "start": 0.1, "band": 0.1, "stop_time": 0.3}),
        Call(metrics.step_metrics, {"time": time, "signal": step, "torque": step, **change}),
        Call(
            metrics.crossing_metrics,
            {"time": time, "speed_motor": step, "speed_load": step, "events": NO_EVENTS, **change},
        ),
    ]


def _recordings() -> list[Call]:
    one = recording()
    return [
        Call(
            lm.Recording,
            {"time": one.time, "signals": dict(one.signals), "origin": {}, "events": (), "meta": {}},
        ),
        Call(one.window, {"start": 0.1, "stop": 0.3}),
        Call(one.impacts, {"merge": 1e-3}),
        Call(
            lm.Sensor, {"source": "speed_motor", "resolution": 0.1, "noise": 0.1, "bias": 0.1, "dropout": 0.1}
        ),
        Call(
            lm.simulation.measure,
            {
                "sensors": {"speed_motor": lm.Sensor("speed_motor")},
                "signals": dict(one.signals),
                "dt": DT,
                "seed": 1,
            },
        ),
    ]


def _systems() -> list[Call]:
    names = {"first": "a", "second": "b", "output": "c", "dt": DT}
    small = {
        "inputs": ("u",),
        "outputs": ("y",),
        "states": ("x",),
        "dt": DT,
        "A": [[0.5]],
        "B": [[1.0]],
        "C": [[1.0]],
    }
    return [
        Call(lm.DiscreteSystem, small | {"curves": (), "name": "law", "initial_state": [0.0]}),
        Call(lm.connect, {"systems": [law()], "inputs": law().inputs, "outputs": law().outputs, "name": "x"}),
        Call(lm.one_sample_delay, {"name": "u", "dt": DT, "delayed": "v", "start": 0.0}),
        Call(systems.linearised, {"system": linear(), "slopes": ()}),
        Call(systems.loop_margin, {"law": linear(), "model": systems.design_model(plant(), DT)}),
        Call(systems.pruned, {"law": law(), "outputs": law().outputs}),
        Call(systems.maximum, names),
        Call(systems.minimum, names),
        Call(systems.rate_limit, {"signal": "a", "output": "b", "rate": 1.0, "dt": DT, "start": 0.0}),
        Call(systems.zero_order_hold, {"A": [[-1.0]], "B": [[1.0]], "dt": DT}),
        Call(systems.design_model, {"drivetrain": plant(), "dt": DT, "delay": 1}),
        Call(systems.InputCheck, {"input": "u", "limit": 1.0, "hold": 5, "forget": 0.5}),
        Call(law().run, {"data": {"speed_reference": np.ones(9), "speed_motor": np.ones(9)}}),
        Call(
            lm.simulate,
            {
                "drivetrain": plant(),
                "dt": DT,
                "torque_motor": np.ones(20),
                "torque_load": np.ones(20),
                "state": (0.0, 0.0, 0.0),
                "delay": 0,
                "seed": 1,
                "sensors": {},
            },
        ),
        Call(lm.simulation.variants, {"drivetrain": plant(), "count": 2, "spread": 0.1, "seed": 1}),
        Call(
            lm.simulate_batch,
            {
                "drivetrains": [plant()],
                "dt": DT,
                "signals": ("speed_motor",),
                "quantiles": (),
                "torque_motor": np.ones(20),
                "chunk": 10,
                "workers": 1,
            },
        ),
    ]


def _laws() -> list[Call]:
    own = {"drivetrain": plant(), "dt": DT}
    wished = {"largest_error": 1.0, "largest_torque": 10.0, "largest_twist": 1.0}
    made = [
        Call(
            controllers.pi,
            {
                "dt": DT,
                "kp": 1.0,
                "ki": 2.0,
                "torque_limit": 5.0,
                "filter_time": 0.01,
                "speed_filter_time": 0.01,
                "friction_of": plant(),
            },
        ),
        Call(
            controllers.pole_placement,
            own | {"poles": (-40.0, -40.0, -40.0), "torque_limit": 5.0, "friction_compensation": "estimated"},
        ),
        Call(controllers.state_feedback, own | {"poles": (-40.0, -40.0, -40.0)}),
        Call(controllers.symmetrical_optimum, own | {"delay": 1, "spread": 2.0}),
        Call(controllers.lqi, own | wished | {"torque_limit": 5.0, "load_torque": False}),
        Call(controllers.quadratic_feedback, own | wished),
        Call(
            controllers.soft_landing,
            own
            | {
                "contact_speed": 1.0,
                "torque_limit": 5.0,
                "braking_torque": 1.0,
                "rate": 10.0,
                "release": 10.0,
            },
        ),
        Call(observers.speed_of_counts, {"dt": DT, "counts": 4096}),
    ]
    return [*made, *_further_laws(own, wished)]


def _further_laws(own: dict[str, Any], wished: dict[str, Any]) -> list[Call]:
    oscillates = wished | {"largest_oscillation": 2.0}
    slides = own | {"switching_torque": 1.0, "torque_limit": 5.0, "poles": (-40.0, -40.0), "rate": 100.0}
    planned = {"largest_error": 1.0, "largest_torque": 10.0, "torque_limit": 5.0, "contact_speed": 0.4}
    course = {"largest_acceleration": 100.0, "largest_jerk": 1e4}
    along = {name: oscillates[name] for name in ("largest_error", "largest_torque", "largest_oscillation")}
    robust = own | oscillates | {"load_torque": 1.0, "margin": 1.5}
    filtered = {"signal": "a", "output": "b", "frequency": 100.0, "dt": DT, "width": 0.7, "depth": 0.1}
    return [
        Call(controllers.active_damping, own | {"damping_ratio": 0.5, "torque_limit": 5.0}),
        Call(controllers.notch, filtered),
        Call(controllers.sliding_mode, slides),
        Call(controllers.super_twisting, slides | {"integral_rate": 10.0}),
        Call(controllers.predictive, own | oscillates | {"torque_limit": 5.0, "moves": 2, "passes": 2}),
        Call(controllers.hybrid_predictive, own | planned),
        Call(controllers.scheduled_lqi, own | oscillates | {"torque_limit": 5.0, "schedule_rate": 20.0}),
        Call(controllers.speed_course, course | {"dt": DT}),
        Call(controllers.torque_ramp, {"unwinding_rate": 4e3, "winding_rate": 2e4, "dt": DT}),
        Call(controllers.flatness, own | course | along | {"torque_limit": 5.0}),
        Call(controllers.robust_feedback, robust),
        Call(controllers.h_infinity, robust | {"torque_limit": 5.0}),
        Call(
            controllers.optimised_pi,
            own | {"torque_limit": 60.0, "speed": 2.0, "torque_load": 5.0, "speed_from_counts": True},
        ),
        Call(controllers.quadratic_poles, {"drivetrain": plant(), "torque_per_error": 1.0}),
    ]


@functools.cache
def proof() -> certificates.RunningProof:
    """Of a loop that is not stable: found out at once."""
    return certificates.prove_running(plant(), controllers.pi(dt=DT, kp=400.0))


@functools.cache
def box() -> certificates.BoxProof:
    """Of the same loop."""
    return certificates.prove_box(plant(), controllers.pi(dt=DT, kp=400.0), {"stiffness": (0.9, 1.1)})


def _certificates() -> list[Call]:
    shaky = controllers.pi(dt=DT, kp=400.0)
    rigid = plant().with_parameters(backlash=0.0, coulomb=0.0)
    loop = {"drivetrain": plant(), "law": shaky, "delay": 0}
    searched = {"fastest": 10.0, "substeps": 1, "step": 1.0, "speeds": [1.0, 2.0]}
    unstable = {
        "drivetrain": plant(),
        "measured": ("speed_motor",),
        "gain": np.array([[0.0], [-50.0], [0.0]]),
    }
    swings = {"reference": 1.0, "torque_load": 0.0}
    boxed = {"box": {"stiffness": (0.9, 1.1)}, "speed": 1.0, "fastest": 10.0, "substeps": 1, "workers": 1}
    return [
        Call(certificates.prove_running, loop | searched | {"torque_load": (0.0, 0.0)}),
        Call(certificates.prove_with_load, loop | searched),
        Call(certificates.prove_box, loop | boxed),
        Call(certificates.box_headline, {"proof": box()}),
        Call(certificates.box_stability, {"proof": box()}),
        Call(
            certificates.simulated,
            {"drivetrain": plant(), "law": shaky, "proof": replace(box(), stops_at=None), "seed": 1},
        ),
        Call(certificates.largest_box, loop | {"parameters": ["stiffness"], "seconds": 1e-9}),
        Call(certificates.around, {"half_width": 0.1, "parameters": ["stiffness"]}),
        Call(
            certificates.peak_bounds,
            {
                "drivetrain": rigid,
                "law": certificates.continuous_pi(),
                "reference": 1.0,
                "delay": 0,
                "substeps": 1,
            },
        ),
        Call(certificates.continuous_state_feedback, {"drivetrain": plant(), "poles": [-400.0] * 3}),
        Call(
            certificates.largest_share,
            {
                "drivetrain": plant().with_parameters(coulomb=0.0),
                "law": certificates.continuous_pi(kp=1e6),
                "criterion": "circle",
            },
        ),
        Call(certificates.continuous_pi, {"kp": 10.0, "ki": 200.0}),
        Call(
            certificates.continuous_observer_feedback,
            {"drivetrain": plant(), "measured": ["speed_motor"], "poles": [-400.0] * 3, "compensation": True},
        ),
        Call(certificates.headline, {"proof": proof()}),
        Call(certificates.conditions, {"proof": proof()}),
        Call(certificates.facts, {"proof": proof()}),
        Call(certificates.stability, {"proof": proof()}),
        Call(certificates.verdict, {"data": {}}),
        Call(certificates.margins, loop | {"law": controllers.pi(dt=DT), "speed": 1.0, "torque_load": 0.0}),
        Call(
            certificates.count_variants,
            loop | swings | {"count": 2, "spread": 0.1, "duration": 0.05, "seed": 1},
        ),
        Call(
            certificates.worst_case,
            {"drivetrain": plant(), "law": shaky, "proof": proof(), "rounds": 1, "seed": 1},
        ),
        Call(
            certificates.worst_reference,
            {
                "drivetrain": plant(),
                "law": shaky,
                "reference": 1.0,
                "signal": "twist",
                "starts": 1,
                "duration": 32 * DT,
                "seed": 1,
            },
        ),
        Call(certificates.limit_cycle, loop | swings | {"state": (0.0, 1.0, 0.0), "settle": 0.05}),
        Call(certificates.harmonic_balance, loop | swings | {"amplitudes": [0.1, 1.0]}),
        Call(
            certificates.limit_cycle_map,
            {
                "build": lambda kp, ki: (plant(), controllers.pi(dt=DT, kp=kp, ki=ki), 1.0),
                "first": ("kp", "Nm s/rad"),
                "first_values": [1.0],
                "second": ("ki", "Nm/rad"),
                "second_values": [2.0],
                "delay": 0,
                "settle": 0.05,
            },
        ),
        Call(
            certificates.observer_error,
            {"drivetrain": plant(), "measured": ("speed_motor",), "gain": np.ones((3, 1)), "faces": 3},
        ),
        Call(certificates.observer_verdict, {"data": {}}),
        Call(certificates.observer_headline, {"proof": certificates.ObserverError(None, None, None)}),
        Call(certificates.observer_share, unstable | {"injection": {"speed_motor": 1e-3}}),
        Call(certificates.best_injection, unstable | {"signal": "speed_motor", "largest": 1e-3}),
    ]


def _identification() -> list[Call]:
    one, r = {"recording": recording()}, identification
    x = {"x": np.random.default_rng(2).normal(size=ROWS), "y": np.random.default_rng(3).normal(size=ROWS)}
    windows = {"window": 64, "noverlap": 32, "nfft": 64, "fs": 1000.0}
    return [
        Call(
            lm.identify,
            one | {"start": plant(), "fixed": (), "measured": ("speed_motor",), "contact": "viscoelastic"},
        ),
        Call(r.compare_contacts, one | {"start": plant(), "fixed": ()}),
        Call(lm.ring_down, one | {"signal": "torque_shaft", "band": (10.0, 200.0), "seed": 1}),
        Call(
            lm.shaft_stiffness,
            one
            | {
                "speed_a": "speed_motor",
                "torque": "torque_shaft",
                "band": (3.0, 60.0),
                "min_coherence": 0.9,
                "torque_delay": 0.0,
            },
        ),
        Call(r.backlash_excited, one | {"signal": "torque_shaft"}),
        Call(r.breakaway, one | {"angle": "angle_motor", "torque": "torque_motor", "travel": 0.1}),
        Call(
            r.frequency_analysis,
            one | RESPONSE,
        ),
        Call(
            r.frequency_response,
            one | RESPONSE,
        ),
        Call(
            r.friction_ladder,
            one
            | {
                "speed": "speed_motor",
                "torque": "torque_motor",
                "plateaus": ((0.0, 0.1), (0.1, 0.2)),
                "inertia": 0.1,
            },
        ),
        Call(
            r.gaussian_equivalent,
            {"drivetrain": plant(), "torque_motor": np.random.default_rng(4).normal(size=ROWS), "dt": DT},
        ),
        Call(
            r.locked_backlash,
            one | {"angle": "angle_motor", "torque": "torque_motor", "resolution": 1e-4, "settling": 0.1},
        ),
        Call(
            r.lost_motion,
            one
            | {
                "angle_motor": "angle_motor",
                "angle_load": "angle_load",
                "torque": "torque_motor",
                "inertia_motor": 0.1,
            },
        ),
        Call(r.mscohere, x | windows),
        Call(r.tfestimate, x | windows | {"estimator": "H1"}),
        Call(
            r.rigid_drive,
            one | {"angle": "angle_motor", "torque": "torque_motor", "inertia": 0.1, "decimation": 5},
        ),
        Call(
            r.evaluate,
            one
            | {
                "found": r.rigid_drive(recording(), decimation=5, inertia=0.1),
                "angle": "angle_motor",
                "torque": "torque_motor",
                "decimation": 5,
            },
        ),
        Call(
            r.torque_step,
            {
                "recordings": recording(),
                "inertia": 0.1,
                "speed": "speed_motor",
                "torque": "torque_motor",
                "min_speed": 0.1,
                "averaging": 0.1,
            },
        ),
        Call(
            r.two_mass_response,
            {
                "parameters": {"inertia_motor": 0.1, "inertia_load": 0.1, "stiffness": 1e3, "damping": 0.1},
                "output": "speed_motor",
                "s": 1j * np.ones(3),
            },
        ),
        Call(
            lm.experiment.design_excitation,
            {
                "nameplate": plant(),
                "kind": "step",
                "duration": 0.5,
                "dt": DT,
                "torque_limit": 5.0,
                "speed_limit": 50.0,
                "angle_limit": 9.0,
                "encoder_bits": 20,
                "seed": 1,
                "plants": 2,
            },
        ),
    ]


def _structure() -> list[Call]:
    shaft = {
        "name": "a",
        "length": 1.0,
        "outer_diameter": 0.05,
        "inner_diameter": 0.01,
        "elements": 2,
        "density": 7850.0,
    }
    total = {"inertia_total": 0.1, "damping_ratio": 0.02}
    return [
        Call(structure.Disc, {"name": "a", "inertia": 0.1}),
        Call(structure.Coupling, {"name": "a", "stiffness": 100.0}),
        Call(structure.Gear, {"name": "a", "ratio": 2.0, "inertia_in": 0.1, "inertia_out": 0.1}),
        Call(structure.ShaftSegment, shaft | {"shear_modulus": 7.93e10}),
        Call(
            structure.TorsionalModel,
            {
                "mass": model().mass,
                "stiffness": model().stiffness,
                "names": ("a", "b", "c"),
                "ratios": np.ones(3),
                "damping_ratio": 0.02,
            },
        ),
        Call(
            structure.assemble,
            {
                "parts": [structure.Disc("a", 0.1), structure.Coupling("b", 10.0), structure.Disc("c", 0.1)],
                "damping_ratio": 0.02,
            },
        ),
        Call(structure.modes, {"model": model()}),
        Call(structure.zeros, {"model": model(), "at": 0}),
        Call(
            structure.reduce_to_chain,
            {"model": model(), "n": 2, "gap": None, "band": (5.0, 150.0), "motor": 0},
        ),
        Call(structure.chain_from_frequencies, {"zeros": [10.0], "poles": [30.0], **total}),
        Call(structure.two_mass_from_frequencies, {"zero": 10.0, "pole": 30.0, **total}),
        Call(structure.from_drivetrain, {"drivetrain": plant(), "damping_ratio": 0.02}),
        Call(structure.paper_powertrain, {"damping_ratio": 0.02}),
    ]


def _rig() -> list[Call]:
    return [
        Call(
            rig.record,
            {"rig": 1, "torque_motor": np.ones(50), "dt": DT, "noise_seed": 0, "channels": ("speed_motor",)},
        ),
        Call(rig.varied_rig, {"seed": 1}),
        Call(rig.bench, {"seed": 1}),
        Call(rig.eigenfrequencies, {"drivetrain": plant()}),
        Call(rig.motor_zeros, {"drivetrain": plant()}),
        Call(rig.two_mass_equivalent, {"drivetrain": plant(), "speed_load": np.ones(9)}),
    ]


def _files(folder: Path) -> list[Call]:
    lm.save_law(law(), folder / "law.json")
    lm.save_recording(recording(), folder / "rig.npz")
    lm.save_drivetrain(plant(), folder / "drivetrain.toml")
    files.write_csv(folder / "rig.csv", recording())
    (folder / "rig.toml").write_text('[[recording]]\nfile = "rig.csv"\n')
    files.save_json(folder / "x.json", "x", {"a": 1})
    channels = {"speed_motor": {"column": "speed_motor"}}
    return [
        Call(
            files.read_recording,
            {
                "path": folder / "rig.csv",
                "time": "time",
                "channels": channels,
                "window": (0.1, 0.3),
                "resample": 1e-3,
            },
        ),
        Call(files.parse_quantity, {"value": "1 ms", "dimension": "s", "where": "x"}),
        Call(files.load_law, {"path": folder / "law.json"}),
        Call(files.load_recording, {"path": folder / "rig.npz"}),
        Call(files.load_drivetrain, {"path": folder / "drivetrain.toml"}),
        Call(files.load_json, {"path": folder / "x.json", "kind": "x"}),
        Call(files.read_configuration, {"path": folder / "rig.toml"}),
        Call(files.find_problems, {"path": folder / "rig.toml"}),
        Call(files.foreign_files, {"path": folder}),
        Call(
            files.read_torsional_model,
            {"mass": folder / "no.npz", "stiffness": folder / "no.npz", "names": (), "damping_ratio": 0.02},
        ),
        Call(files.save_law, {"system": law(), "path": folder / "a.json"}),
        Call(files.save_recording, {"recording": recording(), "path": folder / "a.npz"}),
        Call(files.save_drivetrain, {"drivetrain": plant(), "path": folder / "a.toml"}),
        Call(files.save_json, {"path": folder / "b.json", "kind": "x", "data": {"a": 1}}),
        Call(
            files.write_csv, {"path": folder / "b.csv", "recording": recording(), "names": ("speed_motor",)}
        ),
        Call(
            files.aligned,
            {
                "first": recording(),
                "further": recording(),
                "by": "speed_motor",
            },
        ),
        Call(files.check_recording, {"recording": recording()}),
        Call(files.load_recordings, {"configuration": files.read_configuration(folder / "rig.toml")}),
        Call(
            lm.export.c,
            {
                "law": law(),
                "folder": folder / "c",
                "name": "law",
                "real": "double",
                "vectors": 3,
                "seed": 1,
                "drivetrain": plant(),
            },
        ),
    ]


def _plots() -> list[Call]:
    row = np.arange(9.0)
    return [
        Call(
            plot.recording_overview,
            {"recording": recording(), "title": "x", "signals": ("speed_motor",), "bins": 10},
        ),
        Call(
            plot.control_step,
            {"responses": {"a": recording()}, "start": 0.0, "stop": 0.2, "signals": ("speed_motor",)},
        ),
        Call(plot.bode, {"responses": {"a": (row + 1, row + 1j)}, "unit": "1", "title": "x"}),
        Call(plot.prediction_fit, {"time": 0.01 * row, "measured": row, "predicted": row + 0.1, "lags": 3}),
    ]


def sound_calls(folder: Path) -> list[Call]:
    """All of them; files lie in the folder."""
    made = (
        _drives(),
        _signals(),
        _metrics(),
        _recordings(),
        _systems(),
        _laws(),
        _certificates(),
        _identification(),
        _structure(),
    )
    return [call for part in (*made, _rig(), _files(folder), _plots()) for call in part]
