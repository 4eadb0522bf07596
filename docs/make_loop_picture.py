"""The histograms of docs/real-time.md: python docs/make_loop_picture.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import lostmotion as lm

DT, SAMPLES = 1e-3, 5000


def main() -> None:
    law = lm.controllers.pi(dt=DT, torque_limit=lm.rig.TORQUE_LIMIT)
    step = np.where(np.arange(SAMPLES) < SAMPLES // 2, -2.0, 2.0)
    timing = lm.realtime.run_loop(law, 1, paced=True, speed_reference=step).timing
    figure = lm.plot.loop_timing(timing.round_trip, timing.wake_up, period=DT, title="PI at 1 ms, paced, 5 s")
    figure.savefig(Path(__file__).parent / "images" / "loop-timing.png", dpi=110, facecolor="white")


if __name__ == "__main__":
    main()
