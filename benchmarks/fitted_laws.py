"""Default laws on drives of other sizes: recorded, identified, designed and judged as ``lostmotion run`` does it.

    python benchmarks/fitted_laws.py development --drives 20      # rules are found on these
    python benchmarks/fitted_laws.py test --drives 20             # and judged on these, once for each change of rules
    python benchmarks/fitted_laws.py test --drives 20 --from zoo  # the same on the zoo, which nothing here was tuned on

Every drive is a finer plant of four inertias with Stribeck friction, the gap in a joint beyond the elastic shaft, a
torque lag, one sample of computing delay and an encoder. It is excited in open loop, identified from motor torque and
motor speed with start values up to 40 % off, and the laws that ``stages.design`` makes without any setting but the
torque limit meet the very plant that was recorded.

Drives of the zoo (``rig.drive``) are harder: two to five inertias, operation and load torques instead of a designed
test, start values up to three off or missing, delays up to 2 ms. Taken are those of the same sizes and sample times
with one gap and a two-mass equivalent that log the commanded torque (a measured one does not show the delay with which
a command acts), and of each recording the first 40 000 rows; where identification asks for ``load_torque = true``, it
is given.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count, islice

import numpy as np

import lostmotion as lm
from lostmotion.drivetrain import Actuator
from lostmotion.rig.excitation import Limits, shape
from lostmotion.rig.zoo.draws import Draw
from lostmotion.rig.zoo.plants import plant
from lostmotion.stages.design import Design, design
from lostmotion.stages.material import Material, Settings
from lostmotion.stages.parameters import Found, find_parameters
from lostmotion.stages.speed_step import SpeedStep
from lostmotion.stages.validation import control_step, judged_step

#: Seeds of the drives: rules are found on the first, judged on the second.
SETS = {"development": 0, "test": 1000}
#: The same on the zoo; its test drives are those of no other benchmark.
ZOO = {"development": lm.rig.SETS["development"], "test": range(27_000, 28_000)}
#: The issue's targets: overshoot (% of the step), steady error (fraction of the step).
OVERSHOOT, STEADY_ERROR = 10.0, 0.005
LAWS = ("pi", "pole_placement", "soft_landing")
ROWS = 40_000
#: Total inertia, kg m², and sample time, s: those of the issue.
INERTIA, SAMPLE_TIME = (1e-5, 1e2), (1e-4, 1e-3)
HEADS = (
    "seed", "inertia, kg m²", "load/motor", "mode, Hz", "dt, ms", "law", "overshoot, %", "settling, ms",
    "steady error, %", "peak/limit", "impact, rad/s", "limited by",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class UserDrive:
    """A drive as its user has it: plant with sensors, nameplate, recording, torque limit (Nm), delay (samples)."""

    seed: int
    rig: lm.rig.Rig
    nameplate: dict[str, float]
    recording: lm.Recording
    torque_limit: float
    delay: int = 1


def user_drive(seed: int) -> UserDrive:
    """The drive of a seed: every range below is log-uniform."""
    rng = np.random.default_rng([seed, 13])

    def draw(low: float, high: float) -> float:
        return float(math.exp(rng.uniform(math.log(low), math.log(high))))

    total, ratio, dt = draw(*INERTIA), draw(0.2, 10.0), draw(*SAMPLE_TIME)
    motor, load = total / (1.0 + ratio), total * ratio / (1.0 + ratio)
    pole = 1.0 / (dt * draw(20.0, 100.0))
    stiffness = (2.0 * math.pi * pole) ** 2 * motor * load / total
    speed, time = draw(10.0, 300.0), draw(0.1, 1.0)
    speed = min(speed, 0.1 * stiffness * time / total)  # the shaft winds by 0.1 rad at rated torque at most
    torque = total * speed / time
    limit = 2.0 * torque
    model = lm.Drivetrain.two_mass(
        inertia_motor=motor, inertia_load=load, stiffness=stiffness,
        damping=2.0 * draw(0.01, 0.05) * stiffness / (2.0 * math.pi * pole),
        backlash=draw(0.2, 4.0) * torque / stiffness,
        coulomb=draw(0.01, 0.1) * torque, viscous=draw(0.005, 0.05) * torque / speed,
        coulomb_motor=draw(0.002, 0.02) * torque, viscous_motor=draw(0.001, 0.01) * torque / speed,
        lag=draw(0.3, 2.0) * dt, torque_limit=limit,
    )  # fmt: skip
    finer = lm.rig.finer_rig(model, {}, seed)
    # Counts over one sample: from 0.05 to 0.5 % of rated speed.
    bits = round(math.log2(2.0 * math.pi / (dt * draw(5e-4, 5e-3) * speed)))
    encoder = lm.Sensor("angle_motor", 2.0 * math.pi / 2**bits, difference=True)
    chain = replace(finer.drivetrain, actuator=Actuator(finer.drivetrain.lag, limit))
    rig = replace(finer, drivetrain=chain, sensors={**finer.sensors, "speed_motor": encoder})
    band = (0.02 * pole, min(1.4 * pole, 0.4 / dt))
    wanted = shape(
        "levels", model, Limits(torque, speed, math.inf), band, max(ROWS * dt, 8.0 * time), dt, seed
    )
    recording, _ = lm.rig.record(rig, torque_motor=wanted(1.0), dt=dt, channels=("speed_motor",))
    known = ("inertia_motor", "inertia_load", "stiffness", "backlash", "coulomb")
    nameplate = {
        name: value * draw(1 / 1.4, 1.4) for name, value in model.parameters().items() if name in known
    }
    return UserDrive(seed, rig, nameplate, recording, limit)


def rig_drives(kind: str) -> Iterator[UserDrive]:
    """The drives of a set of the rig's family."""
    yield from map(user_drive, count(SETS[kind]))


def zoo_drives(kind: str) -> Iterator[UserDrive]:
    """The drives of a set of the zoo that have the sizes above, one gap and a two-mass equivalent."""
    for seed in ZOO[kind]:
        chain = plant(Draw(seed)).drivetrain
        if sum(s.has_backlash for s in chain.shafts) == 1 and _within(chain.inertia_total, INERTIA):
            drive = lm.rig.drive(seed)
            fits = drive.truth.parameters["stiffness"] and drive.dimensions["torque"] == "commanded"
            if fits and _within(drive.recording.dt, SAMPLE_TIME):
                yield _zoo_user(drive)


def _within(value: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= value <= bounds[1]


def _zoo_user(drive: lm.rig.Drive) -> UserDrive:
    """What the user of a drive of the zoo has; the law acts after the delay with which the recorded torque acted."""
    limit = drive.nameplate.actuator.torque_limit
    chain = drive.truth.drivetrain
    limited = replace(chain, actuator=Actuator(chain.lag, limit))
    sensors = {"speed_motor": drive.sensor, "speed_load": lm.Sensor("speed_load")}
    rig = lm.rig.Rig(limited, sensors, drive.seed)
    nameplate = {name: value for name, value in drive.nameplate.parameters().items() if value > 0.0}
    delay = max(1, math.ceil(drive.motion.delay / drive.motion.steps))
    recording = drive.recording.window(stop=drive.recording.time[0] + ROWS * drive.recording.dt)
    return UserDrive(drive.seed, rig, nameplate, recording, limit, delay)


def material_of(drive: UserDrive, load_torque: bool = False) -> Material:
    """As the TOML of this drive would give it, with the torque limit alone under [law]."""
    settings = Settings(torque_limit=drive.torque_limit, load_torque=load_torque)
    return Material(
        drive.nameplate, settings, 1, False, drive.recording, None, {"log": drive.recording}, {"log": "identify"}
    )  # fmt: skip


def found_by_user(drive: UserDrive) -> tuple[Material, Found]:
    """Identified as a run does it, once more with ``load_torque = true`` where the remedy says so."""
    material = material_of(drive)
    found = find_parameters(material)
    if any("load_torque = true" in problem.remedy for problem in found.problems):
        material = material_of(drive, load_torque=True)
        found = find_parameters(material)
    return material, found


def judged(drive: UserDrive, laws: Design, name: str) -> tuple[dict[str, float | None], SpeedStep]:
    """Metrics of a law on the drive itself; empty if there is none."""
    law = {"pi": laws.pi, "pole_placement": laws.watched, "soft_landing": laws.landing}[name]
    if law is None:
        return {}, laws.step
    response = control_step(drive.rig, law, laws.dt, laws.step, drive.delay)
    return judged_step(response, laws.step), laws.step


def passes(metrics: dict[str, float | None], limit: float) -> bool:
    """Stable and settled, overshoot, steady error and peak torque within the targets."""
    overshoot, steady, peak = (metrics.get(n) for n in ("overshoot", "steady_error", "peak_torque"))
    return (
        metrics.get("settling_time") is not None
        and overshoot is not None and overshoot <= OVERSHOOT
        and steady is not None and steady <= STEADY_ERROR
        and peak is not None and peak <= limit * (1.0 + 1e-12)
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("set", choices=list(SETS))
    parser.add_argument("--drives", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--from", dest="family", choices=["rig", "zoo"], default="rig")
    arguments = parser.parse_args()
    made, passed = dict.fromkeys(LAWS, 0), dict.fromkeys(LAWS, 0)
    print(f"| {' | '.join(HEADS)} |\n|" + "---|" * len(HEADS))
    everyone = zoo_drives(arguments.set) if arguments.family == "zoo" else rig_drives(arguments.set)
    for drive in islice(everyone, arguments.first, arguments.first + arguments.drives):
        material, found = found_by_user(drive)
        laws = design(material, found)
        if found.drivetrain is None:
            inertia = drive.rig.drivetrain.inertia_total
            print(f"| {drive.seed} | {inertia:.1e} | no laws: {found.missing} |", flush=True)
            continue
        d = found.drivetrain
        reasons = {
            "pi": laws.pi_skipped,
            "pole_placement": laws.skipped,
            "soft_landing": laws.landing_skipped,
        }
        for name in LAWS:
            metrics, _ = judged(drive, laws, name)
            made[name] += bool(metrics)
            passed[name] += passes(metrics, drive.torque_limit)
            drawn = (d.inertia_total, d.inertia_load / d.inertia_motor, d.pole_frequency, 1e3 * laws.dt)
            row = [str(drive.seed), *(f"{value:.2g}" for value in drawn), name]
            row += (
                _cells(metrics, drive.torque_limit, laws, name) if metrics else [f"refused: {reasons[name]}"]
            )
            print(f"| {' | '.join(row)} |", flush=True)
    counts = (f"{name}: {made[name]} handed out, {passed[name]} of them within all targets" for name in LAWS)
    print(f"{arguments.drives} drives. " + "; ".join(counts))


def _cells(metrics: dict[str, float | None], limit: float, laws: Design, name: str) -> list[str]:
    """Of the table: the metrics of a law, and whether it meets the targets or what limits it."""
    scales = (
        ("overshoot", 1.0), ("settling_time", 1e3), ("steady_error", 100.0), ("peak_torque", 1.0 / limit),
        ("impact_speed", 1.0),
    )  # fmt: skip
    cells = ["–" if (v := metrics.get(n)) is None else f"{scale * v:.3g}" for n, scale in scales]
    source = str(laws.taken["pi_kp" if name == "pi" else "poles"]["source"])
    return [*cells, source if passes(metrics, limit) else f"**fails**, {source}"]


if __name__ == "__main__":
    main()
