"""Frequency response of the virtual rig: how far its gap lowers zero and pole, and figures 2, 4, 8 and 9 of the paper.

    python benchmarks/frequency_response.py --figures docs/images

Prints a Markdown table over the torque's amplitude, medians over the seeds: zero and pole fitted to the rig's response,
with gap and with the gap closed, the random-input describing function's prediction, and the coherence at the zero.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion import structure
from lostmotion.identification import (
    FrequencyResponse,
    frequency_response,
    gaussian_equivalent,
    two_mass_fit,
    two_mass_response,
)
from lostmotion.plot import bode, coherence, mode_shapes
from lostmotion.rig.nominal import COULOMB, VISCOUS

DT, SEGMENT, BAND, FIT_BAND = 1e-4, 2.0, (2.0, 250.0), (5.0, 180.0)
AMPLITUDES = (4.0, 8.0, 12.0, 16.0, 24.0)


def torque(rms: float, duration: float, seed: int) -> np.ndarray:
    """Noise from 1 to 300 Hz; the drive limits it."""
    signal = lm.signals.noise(1.0, 300.0, rms, duration, DT, seed=seed)
    return np.clip(signal, -lm.rig.TORQUE_LIMIT, lm.rig.TORQUE_LIMIT)


def closed(rig: lm.rig.Rig) -> lm.rig.Rig:
    """The same rig without its gap."""
    shafts = tuple(replace(shaft, backlash=0.0) for shaft in rig.drivetrain.shafts)
    return replace(rig, drivetrain=replace(rig.drivetrain, shafts=shafts))


def two_mass(rig: lm.rig.Rig) -> lm.Drivetrain:
    """The two masses of the nominal rig, with its gap and friction."""
    values = lm.rig.two_mass_equivalent(rig.drivetrain, np.linspace(-20.0, 20.0, 401))
    return lm.Drivetrain.two_mass(**{**values, "coulomb": COULOMB, "viscous": VISCOUS})


def response(recording: lm.Recording) -> FrequencyResponse:
    return frequency_response(recording, segment=SEGMENT, band=BAND)


def at_zero(found: FrequencyResponse, zero: float) -> float:
    """Lowest coherence within ±5 % of the zero."""
    return float(found.coherence[found.band(0.95 * zero, 1.05 * zero)].min())


def table(duration: float, seeds: range) -> None:
    rig, model = lm.rig.nominal_rig(), two_mass(lm.rig.nominal_rig())
    print("| torque, Nm rms | zero, Hz | predicted | pole, Hz | predicted | zero, gap closed | pole, gap closed |"
          " coherence at the zero: gap | closed |")  # fmt: skip
    print("|---" * 9 + "|")
    for rms in AMPLITUDES:
        rows = []
        for seed in seeds:
            u = torque(rms, duration, seed)
            open_, shut = (response(lm.rig.record(r, torque_motor=u)[0]) for r in (rig, closed(rig)))
            fits = two_mass_fit(open_, band=FIT_BAND).values, two_mass_fit(shut, band=FIT_BAND).values
            predicted = gaussian_equivalent(model, u, DT)
            rows.append([fits[0]["zero"], predicted.zero, fits[0]["pole"], predicted.pole, fits[1]["zero"],
                         fits[1]["pole"], at_zero(open_, fits[0]["zero"]), at_zero(shut, fits[1]["zero"])])  # fmt: skip
        middle = np.median(rows, axis=0)
        cells = [f"{v:.1f}" for v in middle[:6]] + [f"{v:.3f}" for v in middle[6:]]
        print(f"| {rms:g} | " + " | ".join(cells) + " |", flush=True)


def coverage(seeds: int) -> None:
    """Coverage of the fit's intervals: Table I without gap and friction, with sensor noise."""
    values = {n: TABLE_I[n] for n in ("inertia_motor", "inertia_load", "stiffness", "damping")}
    plant = lm.Drivetrain.two_mass(**values)
    true = {
        **values,
        "zero": plant.zero_frequency,
        "pole": plant.pole_frequency,
        "viscous": 0.0,
        "delay": 0.0,
    }
    print("\n| output | " + " | ".join(true) + " |\n" + "|---" * (len(true) + 1) + "|")
    for output, start in (("speed_motor", None), ("speed_load", plant)):
        hits: dict[str, list[bool]] = {name: [] for name in true}
        for seed in range(seeds):
            u = lm.signals.noise(1.0, 300.0, 5.0, 60.0, 1e-3, seed=seed)
            exact = lm.simulate(plant, dt=1e-3, torque_motor=u)
            noise = 0.2 * np.random.default_rng(seed).standard_normal(len(exact))
            found = frequency_response(
                exact.with_signals("simulated", **{output: exact[output] + noise}), output=output, segment=6.0
            )
            intervals = two_mass_fit(found, band=(3.0, 280.0), start=start).intervals
            for name in true:
                if name in intervals:
                    hits[name].append(intervals[name][0] <= true[name] <= intervals[name][1])
        cells = [f"{sum(hit)} of {len(hit)}" if hit else "kept" for hit in hits.values()]
        print(f"| {output} | " + " | ".join(cells) + " |", flush=True)


def figures(folder: Path, duration: float, rms: float = 16.0) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    model = structure.paper_powertrain()
    found = structure.modes(model)
    mode_shapes(found.frequency, found.own_shapes(), model.names).savefig(
        folder / "figure-2-modes.png", dpi=100
    )
    frequency = np.geomspace(5.0, 1000.0, 3000)
    two = structure.two_mass_from_frequencies(
        zero=structure.zeros(model)[0], pole=found.frequency[1], inertia_total=model.inertia_total
    )
    four = structure.reduce_to_chain(model, 4, gap=structure.GAP, band=(5.0, 900.0), gap_shaft=2).drivetrain
    chain = structure.modes(structure.from_drivetrain(four)).transfer(0, 0, frequency)
    curves = {
        "finite elements": (frequency, found.transfer(0, 0, frequency)),
        "two masses (four equations)": (
            frequency, two_mass_response(two.parameters(), "angle_motor", 2j * np.pi * frequency)),
        "chain of four": (frequency, chain),
    }  # fmt: skip
    bode(curves, title="Motor angle over motor torque: powertrain and reductions").savefig(
        folder / "figure-4-reduction.png", dpi=100
    )
    rig, u = lm.rig.nominal_rig(), torque(rms, duration, 1)
    equivalent = two_mass(rig)
    measured = response(lm.rig.record(rig, torque_motor=u)[0])
    nonlinear = response(lm.simulate(equivalent, dt=DT, torque_motor=u))
    linear = response(lm.simulate(equivalent.with_parameters(backlash=0.0), dt=DT, torque_motor=u))
    shown = {"virtual rig": measured, "nonlinear model": nonlinear, "linear model": linear}
    bode(
        {name: (f.frequency, f.response) for name, f in shown.items()},
        title=f"Motor angle over motor torque, {rms:g} Nm rms",
        marks={"zero, linear": equivalent.zero_frequency, "pole, linear": equivalent.pole_frequency},
    ).savefig(folder / "figure-8-frequency-response.png", dpi=100)
    coherence(
        {name: (f.frequency, f.coherence) for name, f in shown.items()},
        by_chance=measured.coherence_by_chance,
    ).savefig(folder / "figure-9-coherence.png", dpi=100)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seconds", type=float, default=120.0, help="length of each recording")
    parser.add_argument("--seeds", type=int, default=3, help="torques 1 to SEEDS for each amplitude")
    parser.add_argument(
        "--coverage", type=int, default=0, help="instead, count the intervals that contain the truth"
    )
    parser.add_argument("--figures", type=Path, help="folder for the figures")
    arguments = parser.parse_args()
    if arguments.coverage:
        return coverage(arguments.coverage)
    table(arguments.seconds, range(1, arguments.seeds + 1))
    if arguments.figures:
        figures(arguments.figures, arguments.seconds)


if __name__ == "__main__":
    main()
