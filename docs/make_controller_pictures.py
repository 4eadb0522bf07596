"""Where the motor's oscillation under pole placement comes from: python docs/make_controller_pictures.py"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import lostmotion as lm
from lostmotion.plot.style import SERIES

IMAGES = Path(__file__).parent / "images"
DT, STEP, LIMIT, POLE = 1e-4, 0.3, 73.5, -400.0
SEEDS = range(401, 406)
REFERENCE = lm.signals.steps((STEP,), (-2.0, 2.0), 0.6, DT)
#: Speeds at which the rig's friction is drawn as a line, rad/s.
SPEEDS = np.linspace(1.0, 40.0, 50)
SHOWN = ("as it is", "no gap", "only two masses, and nothing else")


def model_of(drivetrain: lm.Drivetrain) -> lm.Drivetrain:
    """The two-mass drivetrain that an identification should find."""
    return lm.Drivetrain.two_mass(**lm.rig.two_mass_equivalent(drivetrain, SPEEDS))


def law_of(
    model: lm.Drivetrain,
    friction: str = "estimated",
    delay: int = 1,
    pole: float = POLE,
    limit: float = LIMIT,
) -> lm.DiscreteSystem:
    """Observer 1 and pole placement; with a delay the observer gets the torque when it acts, and counts."""
    observer = lm.observers.kalman(model, dt=DT, speed_from_counts=delay > 0)
    control = lm.controllers.pole_placement(
        model, poles=(pole, pole, pole), dt=DT, torque_limit=limit, friction_compensation=friction
    )
    parts = [observer, control]
    if delay:
        acting = lm.one_sample_delay("torque_motor", DT, "torque_motor_acting")
        parts = [observer.renamed({"torque_motor": "torque_motor_acting"}), control, acting]
    return lm.connect(parts, inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))


def step(
    drivetrain: lm.Drivetrain, law: lm.DiscreteSystem, delay: int = 1, **sensors: lm.Sensor
) -> lm.Recording:
    return lm.simulate(drivetrain, dt=DT, law=law, delay=delay, sensors=sensors, speed_reference=REFERENCE)


def swing(run: lm.Recording) -> float:
    """How far the motor falls behind the load once the load is past the middle of the step, rad/s."""
    middle = run.time[(run.time > STEP) & (run["speed_load"] > 0.0)][0]
    return float(np.max((run["speed_load"] - run["speed_motor"])[run.time >= middle]))


def cases(seed: int) -> Iterator[tuple[str, lm.Recording]]:
    """The step on one rig, as it is and with causes taken away."""
    rig = lm.rig.varied_rig(seed)
    plant, sensor = rig.drivetrain, rig.sensors["speed_motor"]
    model = model_of(plant)
    closed = replace(plant, shafts=tuple(replace(shaft, backlash=0.0) for shaft in plant.shafts))
    fast = replace(plant, actuator=lm.Actuator(0.0, LIMIT))
    quick = model.with_parameters(lag=0.0)
    bare = quick.with_parameters(backlash=0.0, coulomb=0.0, viscous=0.0)
    yield SHOWN[0], step(plant, law_of(model), speed_motor=sensor)
    yield SHOWN[1], step(closed, law_of(model.with_parameters(backlash=0.0)), speed_motor=sensor)
    yield "two masses", step(model.with_parameters(torque_limit=LIMIT), law_of(model), speed_motor=sensor)
    yield "ideal sensor, no delay, no lag", step(fast, law_of(quick, delay=0), delay=0)
    yield "no friction compensation", step(plant, law_of(model, "none"), speed_motor=sensor)
    yield SHOWN[2], step(bare, law_of(bare, delay=0, limit=np.inf), delay=0)
    yield "poles at −200", step(plant, law_of(model, pole=-200.0), speed_motor=sensor)
    for bits in (16, 14, 12, 10):
        coarse = lm.Sensor("angle_motor", 2.0 * np.pi / 2**bits, difference=True)
        yield f"encoder of {bits} bit", step(plant, law_of(model), speed_motor=coarse)


def designed(model: lm.Drivetrain, time: np.ndarray) -> np.ndarray:
    """(J_load/k)·(second derivative of the load speed's step response with three equal poles), rad/s."""
    t = np.maximum(time - STEP, 0.0)
    second = 4.0 * POLE**2 * -POLE * t * (1.0 + 0.5 * POLE * t) * np.exp(POLE * t)
    return model.inertia_load / model.stiffness * second


def main() -> None:
    rows: dict[str, list[tuple[float, float]]] = {}
    for seed in SEEDS:
        for name, run in cases(seed):
            rest = float(np.std(run["torque_motor"][run.time > 0.5]))
            rows.setdefault(name, []).append((swing(run), rest))
    for name, values in rows.items():
        swings, rests = np.array(values).T
        print(f"{name:36s} swing {np.median(swings):.2f} rad/s   torque at rest {np.median(rests):.2g} Nm")
    figure = Figure(figsize=(8.0, 3.8), layout="constrained")
    axis = figure.subplots()
    for (name, run), line in zip(((n, r) for n, r in cases(401) if n in SHOWN), SERIES, strict=False):
        axis.plot(1e3 * (run.time - STEP), run["speed_motor"] - run["speed_load"], label=name, **line)
    model = model_of(lm.rig.varied_rig(401).drivetrain)
    print(f"formula, rig 401: {-np.min(designed(model, run.time)):.2f} rad/s")
    axis.plot(
        1e3 * (run.time - STEP), designed(model, run.time), "k:", label="(J_load/k) · designed load jerk"
    )
    axis.set(xlim=(-2.0, 40.0), xlabel="time after the step (ms)", ylabel="motor − load speed (rad/s)")
    axis.set_title("Step −2 → 2 rad/s with Observer 1 and pole placement (virtual rig, simulated)")
    axis.legend()
    figure.savefig(IMAGES / "motor-oscillation.png", dpi=100, facecolor="white")


if __name__ == "__main__":
    main()
