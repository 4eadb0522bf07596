"""What a new user waits for: installation, first and later runs, a small simulation, each in fresh processes.

    python benchmarks/first_run.py               # two minutes; builds from this tree into a temporary environment

Kernels that the first run had to compile although the build compiles kernels are listed: there should be none.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
SMALL = """
import numpy as np, lostmotion as lm
plant = lm.Drivetrain.two_mass(inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397,
    backlash=0.012, coulomb=2.0, viscous=0.0175)
print(lm.simulate(plant, torque_motor=np.full(1000, 5.0), dt=1e-4)["speed_load"][-1])
"""


def seconds(*command: str | Path, repeat: int = 1, **environment: str) -> tuple[float, str]:
    """Median wall time of a command, and what it said."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        done = subprocess.run(
            command, cwd=ROOT, env={**os.environ, **environment}, capture_output=True, text=True, check=True
        )
        times.append(time.perf_counter() - start)
    return sorted(times)[repeat // 2], done.stdout + done.stderr


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        seconds(sys.executable, "-m", "venv", folder / "venv")
        tools = folder / "venv" / "bin"
        installation, _ = seconds(tools / "pip", "install", "--quiet", ".")
        command = (tools / "lostmotion", "run", "--out", folder / "out")
        first, said = seconds(*command, NUMBA_DEBUG_CACHE="1")
        warm, _ = seconds(*command, repeat=3)
        small, _ = seconds(tools / "python", "-c", SMALL, repeat=5)
    print(
        f"installation {installation:.1f} s, first run {first:.1f} s, together {installation + first:.1f} s"
    )
    print(f"later runs {warm:.1f} s, small simulation in a fresh process {small:.2f} s")
    compiled = re.findall(r"data saved to '.*/kernels/(.*)\.py\d+", said)
    print("compiled in the first run:", ", ".join(compiled) or "nothing")


if __name__ == "__main__":
    main()
