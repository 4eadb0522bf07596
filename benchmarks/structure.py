"""The paper's powertrain in finite elements and its reductions: the tables of docs/benchmarks/structure.md.

python benchmarks/structure.py
"""

from __future__ import annotations

import numpy as np

from lostmotion import structure
from lostmotion.structure import ChainReduction, TorsionalModel


def powertrain(model: TorsionalModel) -> None:
    found, zeros = structure.modes(model), structure.zeros(model)
    print("| | finite elements | wanted |\n|---|---|---|")
    print(
        f"| eigenfrequencies, Hz | {', '.join(f'{f:.2f}' for f in found.frequency[:4])} | 0, 100 ± 1.5, 750 ± 20 |"
    )
    print(f"| motor zeros, Hz | {', '.join(f'{f:.2f}' for f in zeros[:2])} | 38 ± 0.5 |")
    print(f"| total inertia, kg m² | {model.inertia_total:.5f} | 0.1292 |")
    sides = model.inertia_sides(structure.GAP)
    print(f"| motor and load side of the gap, kg m² | {sides[0]:.6f}, {sides[1]:.6f} | – |")
    swing = dict(zip(model.names, found.shapes[:, 1] / found.shapes[0, 1], strict=True))
    shown = ("motor", "clutch output", "joint", "hub", "brake disc")
    print(
        f"| angles in the 100 Hz eigenmode: {', '.join(shown)} | {', '.join(f'{swing[n]:+.3f}' for n in shown)} | |\n"
    )


def row(what: str, found: ChainReduction) -> str:
    linear = structure.from_drivetrain(found.drivetrain)
    frequencies = ", ".join(f"{f:.1f}" for f in structure.modes(linear).frequency[1:])
    zeros = ", ".join(f"{f:.1f}" for f in structure.zeros(linear))
    inertias = ", ".join(f"{j:.6f}" for j in found.drivetrain.inertias)
    stiffnesses = ", ".join(f"{shaft.stiffness:.0f}" for shaft in found.drivetrain.shafts)
    return f"| {what} | {inertias} | {stiffnesses} | {frequencies} | {zeros} | {found.worst_db:.3g} |"


def reductions(model: TorsionalModel) -> None:
    print("| chain | inertias, kg m² | stiffnesses, Nm/rad | poles, Hz | zeros, Hz | largest error, dB |")
    print("|---" * 6 + "|")
    cases: list[tuple[str, int, str | None, tuple[float, float], int | None]] = [
        ("two, sides of the gap exact, 5–150 Hz", 2, structure.GAP, (5.0, 150.0), None),
        ("two, total exact, 5–150 Hz", 2, None, (5.0, 150.0), None),
        ("three, sides exact, 5–900 Hz", 3, structure.GAP, (5.0, 900.0), None),
        ("four, sides exact, 5–900 Hz", 4, structure.GAP, (5.0, 900.0), 2),
    ]
    for what, n, gap, band, shaft in cases:
        print(row(what, structure.reduce_to_chain(model, n, gap=gap, band=band, gap_shaft=shaft)))
    exact = structure.two_mass_from_frequencies(
        zero=structure.zeros(model)[0],
        pole=structure.modes(model).frequency[1],
        inertia_total=model.inertia_total,
    )
    print(f"\nFour equations: {np.round(exact.inertias, 6).tolist()} kg m², {exact.stiffness:.0f} Nm/rad, "
          f"{exact.damping:.4f} Nm s/rad")  # fmt: skip


def main() -> None:
    model = structure.paper_powertrain()
    powertrain(model)
    reductions(model)


if __name__ == "__main__":
    main()
