"""Claims of section II: eigenmodes of the finite elements, and their reduction to two masses."""

from __future__ import annotations

import numpy as np

from ...drivetrain import Drivetrain
from ...identification import two_mass_response
from ...structure import TorsionalModel, modes, zeros
from .. import published
from ..claim import Claim, judged
from ..experiments import Experiments

#: "approx." in the paper's frequencies, as a share (option).
ABOUT = 0.02
#: Where the reduction is judged: up to this frequency, Hz, from a decade below the zero on, and not within this share
#: of zero and pole; largest error, dB (option).
FROM, UP_TO, AROUND, LARGEST_DB = 4.0, 200.0, 0.03, 1.0
#: Bodies that swing against the rest in the 100 Hz eigenmode (section II).
AGAINST = ("joint", "hub", "brake disc")


def claims(e: Experiments) -> list[Claim]:
    return [
        two_modes(e.structure),
        shape(e.structure),
        four_numbers(published.paper_drivetrain()),
        reduction(e.structure, e.reduced),
    ]


def two_modes(structure: TorsionalModel) -> Claim:
    """Rigid rotation, and two eigenmodes below 1 kHz at about 100 and 750 Hz."""
    frequency = modes(structure).frequency
    found = frequency[(frequency > 0.0) & (frequency < 1000.0)]
    wanted = (published.POLE, published.THIRD)
    near = [bool(np.any(np.abs(found / f - 1.0) <= ABOUT)) for f in wanted]
    return Claim(
        name="two modes below 1 kHz",
        says="The second eigenfrequency is at approx. 100 Hz, the third at about 750 Hz.",
        where="section II, Fig. 2",
        quantity="eigenfrequencies above 0 and below 1000 Hz, Hz",
        value=tuple(map(float, found)),
        tolerance=f"exactly two, within {100 * ABOUT:g} % of 100 and 750 Hz",
        verdict=judged(frequency[0] == 0.0 and found.size == 2, all(near)),
        sentence=f"The finite elements have {_listed(found)} Hz below 1 kHz. The paper gives no geometry: "
        "diameters and inertias were solved for these frequencies, so this shows that such a powertrain "
        "exists, not more.",
    )


def shape(structure: TorsionalModel) -> Claim:
    """Disc, hub and joint swing against all that is on the motor's side."""
    found = modes(structure)
    angle = found.own_shapes()[:, 1] / found.own_shapes()[0, 1]
    against = {name for name, a in zip(structure.names, angle, strict=True) if a < 0.0}
    last = float(angle[-1])
    return Claim(
        name="disc, hub and joint against the rest",
        says="At about 100 Hz brake disc, wheel hub and CV joint oscillate against the rest of the powertrain.",
        where="section II, Fig. 2",
        quantity="angle of the brake disc over that of the motor",
        value=(last,),
        tolerance="negative at joint, hub and brake disc, positive at all other nodes",
        verdict=judged(against == set(AGAINST)),
        sentence=f"Opposite to the motor turn: {', '.join(n for n in structure.names if n in against) or 'none'}; "
        f"the brake disc by {abs(last):.2f} of the motor's angle.",
    )


def four_numbers(table: Drivetrain) -> Claim:
    """Table I has the zero, the pole, the damping ratio and the inertia from which it was computed."""
    value = (table.zero_frequency, table.pole_frequency, table.damping_ratio, table.inertia_total)
    wanted = (published.ZERO, published.POLE, published.DAMPING_RATIO, published.INERTIA_TOTAL)
    off = [abs(v / w - 1.0) for v, w in zip(value, wanted, strict=True)]
    return Claim(
        name="Table I follows from four numbers",
        says="Stiffness, damping and both inertias follow from the first zero (38 Hz), the second pole (100 "
        "Hz), the damping ratio 0.02 and the total inertia.",
        where="section II, Table I",
        quantity="zero, Hz; pole, Hz; damping ratio; total inertia, kg m²",
        value=value,
        tolerance=f"each within {100 * ABOUT:g} % of 38, 100, 0.02, 0.1292",
        verdict=judged(*(x <= ABOUT for x in off)),
        sentence=f"Table I has its zero at {value[0]:.2f} Hz, its pole at {value[1]:.2f} Hz and the damping ratio "
        f"{value[2]:.5f}: at most {100 * max(off):.1f} % from the four numbers.",
    )


def reduction(structure: TorsionalModel, reduced: Drivetrain) -> Claim:
    """The linear two masses respond as the finite elements do up to 200 Hz."""
    frequency = np.geomspace(FROM, UP_TO, 2000)
    full = modes(structure).transfer(0, 0, frequency)
    two = two_mass_response(
        reduced.parameters(), "angle_motor", np.asarray(2j * np.pi * frequency, dtype=complex)
    )
    resonances = (zeros(structure)[0], modes(structure).frequency[1])
    away = np.all([np.abs(frequency / f - 1.0) > AROUND for f in resonances], axis=0)
    worst = float(np.max(np.abs(20.0 * np.log10(np.abs(two / full)))[away]))
    return Claim(
        name="two masses respond as the finite elements",
        says="The FEM model can be reduced to a two mass oscillator.",
        where="section II, Fig. 4",
        quantity=f"largest error of motor angle over motor torque up to {UP_TO:g} Hz, dB",
        value=(worst,),
        tolerance=f"at most {LARGEST_DB:g} dB, except within {100 * AROUND:g} % of zero and pole",
        verdict=judged(worst <= LARGEST_DB),
        sentence=f"Up to {UP_TO:g} Hz the two masses are {worst:.2f} dB off at most.",
    )


def _listed(values: np.ndarray) -> str:
    return " and ".join(f"{v:.1f}" for v in values) or "none"
