"""Design of a test for the virtual rig: predicted half widths of the intervals against those found.

    python benchmarks/excitation.py --seeds 10

One test is designed from rough values, then applied to rigs 1 to SEEDS. Prints a Markdown table: the predicted half
width, then the half width found on each rig over the predicted one.
"""

from __future__ import annotations

import numpy as np
from shared import parser_of

import lostmotion as lm
from lostmotion.experiment import design_excitation
from lostmotion.identification.prediction_error.innovations import NAMES
from lostmotion.stages.material import RIG_NAMEPLATE

#: The rig's nominal values as a two-mass drivetrain; the rigs of the seeds are within 10 and 20 % of them.
NOMINAL = {
    "inertia_motor": 0.0196, "inertia_load": 0.1096, "stiffness": 6570.0, "damping": 0.39, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175, "lag": 3e-4,
}  # fmt: skip


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=10, help="rigs 1 to SEEDS")
    parser.add_argument("--kind", default="levels")
    parser.add_argument("--nameplate", choices=("nominal", "rough"), default="nominal")
    arguments = parser.parse_args()
    values = NOMINAL if arguments.nameplate == "nominal" else RIG_NAMEPLATE
    nameplate = lm.Drivetrain.two_mass(**values)
    design = design_excitation(nameplate, kind=arguments.kind, torque_limit=40.0, speed_limit=45.0)
    names = [n for n in NAMES if n in design.half_widths]
    print("| rig | " + " | ".join(names) + " | fastest rad/s |")
    print("|---" * (len(names) + 2) + "|")
    cells = [f"{100.0 * design.half_widths[n]:.1f} %" for n in names]
    print("| **predicted** | " + " | ".join(cells) + f" | {design.peaks['speed']:.0f} |", flush=True)
    ratios = []
    for seed in range(1, arguments.seeds + 1):
        recording, truth = lm.rig.record(seed, torque_motor=design.recording["torque_motor"])
        found = lm.identify(recording, start=nameplate)
        half = {n: (b - a) / 2.0 / getattr(found.drivetrain, n) for n, (a, b) in found.intervals.items()}
        ratios.append([half.get(n, np.nan) / design.half_widths[n] for n in names])
        fastest = float(np.max(np.abs(truth.signals["speed_motor"])))
        print(f"| {seed} | " + " | ".join(f"{r:.2f}" for r in ratios[-1]) + f" | {fastest:.0f} |", flush=True)
    table = np.array(ratios)
    within = np.sum((table > 1.0 / 1.5) & (table < 1.5), axis=0)
    cells = [f"{w} of {len(table)}" for w in within]
    print("| **within 1.5** | " + " | ".join(cells) + " | |")


if __name__ == "__main__":
    main()
