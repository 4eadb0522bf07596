"""A servo axis as its drive would log it: a plain integrator that knows nothing of lostmotion.

    python examples/servo_log.py servo.csv

Writes the CSV that docs/tutorial.md starts from: replace it by your own. Motor and load are integrated in steps of
10 µs (semi-implicit Euler); the shaft pushes only in contact; friction takes at most what brings an inertia to rest.
"""

from __future__ import annotations

import random
import sys
from math import copysign, exp, floor, pi
from pathlib import Path

#: The axis. kg m², Nm/rad, Nm s/rad, rad (0.5°), Nm.
INERTIA_MOTOR, INERTIA_LOAD, STIFFNESS, DAMPING, BACKLASH = 3e-5, 2e-4, 40.0, 0.004, 0.5 * pi / 180.0
FRICTION_MOTOR, FRICTION_LOAD, VISCOUS_LOAD = 0.004, 0.012, 5e-5
#: The drive: torque per current (Nm/A), current limit (A), lag of the current loop (s), log and control (s), counts.
TORQUE_CONSTANT, CURRENT_LIMIT, LAG, SAMPLE, COUNTS = 0.05, 6.0, 2e-4, 2.5e-4, 2**16
STEP, DURATION = 1e-5, 12.0
#: Speed levels, rad/s, two in each direction, and noise on the current (A), held for 2 ms, that reverses the torque.
LEVELS, NOISE, HOLD = (20.0, 90.0, -90.0, -20.0) * 2, 0.9, 2e-3


def shaft_torque(twist: float, rate: float) -> float:
    """Spring and damper behind half the backlash on either side; they push and never pull. Nm."""
    elastic = twist - copysign(min(abs(twist), 0.5 * BACKLASH), twist)
    if elastic == 0.0:
        return 0.0
    torque = STIFFNESS * elastic + DAMPING * rate
    return torque if torque * elastic > 0.0 else 0.0


def rubbed(speed: float, friction: float, inertia: float) -> float:
    """The speed after a step with Coulomb friction, which never turns an inertia round. rad/s."""
    return speed - copysign(min(abs(speed), friction * STEP / inertia), speed)


def log(seed: int = 1) -> list[tuple[float, float, float]]:
    """Rows of time (s), motor speed from counts (rad/s) and commanded current (A)."""
    noise, rows = random.Random(seed), []
    angle_motor = angle_load = speed_motor = speed_load = torque = integral = wanted = disturbance = 0.0
    counts, steps, lagging = 0, round(SAMPLE / STEP), 1.0 - exp(-STEP / LAG)
    for row in range(round(DURATION / SAMPLE)):
        time = row * SAMPLE
        now = floor(angle_motor / (2.0 * pi) * COUNTS)
        measured, counts = (now - counts) * 2.0 * pi / COUNTS / SAMPLE, now
        # A soft speed control, so that the axis keeps its levels, with noise on its current.
        level = LEVELS[min(int(time / DURATION * len(LEVELS)), len(LEVELS) - 1)]
        wanted += max(-0.5, min(0.5, level - wanted))
        if row % round(HOLD / SAMPLE) == 0:
            disturbance = noise.gauss(0.0, NOISE)
        integral += 0.02 * (wanted - measured) * SAMPLE
        current = (0.004 * (wanted - measured) + integral) / TORQUE_CONSTANT + disturbance
        current = max(-CURRENT_LIMIT, min(CURRENT_LIMIT, current))
        rows.append((time, measured, current))
        for _ in range(steps):
            torque += lagging * (TORQUE_CONSTANT * current - torque)
            shaft = shaft_torque(angle_motor - angle_load, speed_motor - speed_load)
            speed_motor = rubbed(
                speed_motor + STEP * (torque - shaft) / INERTIA_MOTOR, FRICTION_MOTOR, INERTIA_MOTOR
            )
            speed_load += STEP * (shaft - VISCOUS_LOAD * speed_load) / INERTIA_LOAD
            speed_load = rubbed(speed_load, FRICTION_LOAD, INERTIA_LOAD)
            angle_motor += STEP * speed_motor
            angle_load += STEP * speed_load
    return rows


def main() -> None:
    """As a German drive tool exports it: semicolons, decimal commas, ms, revolutions per minute, current."""
    lines = ["Zeit [ms];Drehzahl [U/min];Strom [A]"]
    for time, speed, current in log():
        lines.append(f"{1e3 * time:.2f};{30.0 / pi * speed:.4f};{current:.4f}".replace(".", ","))
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "servo.csv")
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
