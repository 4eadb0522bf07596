"""Finite elements: assembly, modes and responses, against theory and against openTorsion."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.structure import Coupling, Disc, Gear, ShaftSegment, TorsionalModel, assemble, modes, zeros
from lostmotion.structure.powertrain import PARTS

STEEL = {"shear_modulus": 80e9, "density": 8000.0}
GEARED = [
    Disc("motor", 0.02),
    ShaftSegment("input", 0.3, 0.04, 0.02, elements=3, **STEEL),
    Disc("pinion side", 0.001),
    Gear("stage", -3.0, 0.002, 0.05),
    ShaftSegment("output", 0.5, 0.06, elements=4, **STEEL),
    Coupling("flange", 5e4),
    Disc("load", 2.0),
]


def opentorsion_assembly(parts):
    ot = pytest.importorskip("opentorsion", reason="openTorsion is not installed")
    shafts, discs, gears, node = [], [], [], 0
    for part in parts:
        if isinstance(part, Disc):
            discs.append(ot.Disk(node, part.inertia))
        elif isinstance(part, Coupling):
            shafts.append(ot.Shaft(node, node + 1, k=part.stiffness))
            node += 1
        elif isinstance(part, Gear):
            # Its gears always reverse; the radii are those of the ratio. Both wheels have a node of their own.
            parent = ot.Gear(node, part.inertia_in, R=1.0)
            gears += [parent, ot.Gear(node + 1, part.inertia_out, R=-part.ratio, parent=parent)]
            node += 1
        else:
            length, m = part.length, part.elements
            data = {"odl": 1e3 * part.outer_diameter, "idl": 1e3 * part.inner_diameter}
            data |= {"G": part.shear_modulus, "rho": part.density}
            for _ in range(m):
                shafts.append(ot.Shaft(node, node + 1, 1e3 * length / m, **data))
                node += 1
    return ot.Assembly(shafts, discs, gears or None)


def their_angles(assembly, frequency, damping_ratio):
    """openTorsion's angles (nodes, frequencies) for a unit torque at node 0 with its own modal damping."""
    n = len(assembly.M)
    damping = assembly.C_modal(assembly.M, assembly.K, xi=damping_ratio).real
    torque = np.zeros((n, len(frequency)), dtype=complex)
    torque[0] = 1.0
    return assembly.ss_response(torque, 2.0 * np.pi * np.asarray(frequency), C=damping)[0]


@pytest.mark.parametrize("parts", [PARTS, GEARED], ids=["paper", "geared"])
def test_equals_opentorsion(parts):
    model, assembly = assemble(parts), opentorsion_assembly(parts)
    found = modes(model)
    theirs = np.sort(np.sqrt(np.abs(assembly.undamped_modal_analysis()[0]))) / (2.0 * np.pi)
    assert found.frequency[0] == 0.0
    np.testing.assert_allclose(found.frequency[1:], theirs[1:], rtol=1e-8)
    # Their rigid mode has a frequency of rounding and so some damping; so errors count against rigid rotation too.
    for frequency, ratio in (([1.0, 7.0, 20.0], 0.0), ([55.0, 120.0, 400.0, 900.0], 0.02)):
        angles = their_angles(assembly, frequency, ratio)
        rigid = 1.0 / (model.inertia_total * (2.0 * np.pi * np.array(frequency)) ** 2)
        for end in (0, -1):
            error = np.abs(found.transfer(0, end, frequency, damping_ratio=ratio) - angles[end])
            assert np.max(error / np.maximum(np.abs(angles[end]), rigid)) < 1e-8
    if parts is PARTS:
        np.testing.assert_allclose(model.mass, assembly.M, rtol=1e-12, atol=1e-18)
        np.testing.assert_allclose(model.stiffness, assembly.K, rtol=1e-12, atol=1e-9)


def test_free_uniform_shaft():
    """f_n = n/(2L)·√(G/ρ); linear elements with consistent mass are high by (nπ/m)²/24 (Cook, FEA, ch. 11)."""
    shaft = ShaftSegment("bar", 2.0, 0.03, elements=60)
    found = modes(assemble([shaft])).frequency[:4]
    exact = np.arange(4) / (2.0 * shaft.length) * np.sqrt(shaft.shear_modulus / shaft.density)
    np.testing.assert_allclose(
        found[1:] / exact[1:] - 1.0, (np.arange(1, 4) * np.pi / 60) ** 2 / 24.0, rtol=0.02
    )


def test_gear_refers_inertia_and_angles_to_the_first_shaft():
    model = assemble([Disc("motor", 1.0), Gear("stage", 5.0), Coupling("shaft", 250.0), Disc("load", 50.0)])
    assert model.inertia_total == pytest.approx(3.0)
    assert modes(model).frequency[1] == pytest.approx(np.sqrt(10.0 * 1.5) / (2.0 * np.pi))
    slow = (
        modes(model).transfer("motor", "load", [1e-4])[0] / modes(model).transfer("motor", "motor", [1e-4])[0]
    )
    assert slow.real == pytest.approx(0.2, rel=1e-6)


def test_reciprocity_and_residue_of_rigid_rotation():
    found = modes(assemble(GEARED))
    frequency = np.array([5.0, 40.0, 300.0])
    np.testing.assert_allclose(
        found.transfer("motor", "load", frequency), found.transfer("load", "motor", frequency), rtol=1e-12
    )
    total = found.model.inertia_total
    assert found.transfer(0, 0, [1e-3])[0].real * -((2e-3 * np.pi) ** 2) * total == pytest.approx(
        1.0, rel=1e-6
    )


def test_zeros_are_modes_with_the_place_held():
    model = assemble([Disc("a", 2.0), Coupling("k", 50.0), Disc("b", 3.0)])
    assert zeros(model) == pytest.approx([np.sqrt(50.0 / 3.0) / (2.0 * np.pi)])
    assert zeros(model, "b") == pytest.approx([np.sqrt(25.0) / (2.0 * np.pi)])


def test_grounded_matrices_have_no_rigid_mode():
    model = TorsionalModel(np.eye(2), np.array([[300.0, -100.0], [-100.0, 100.0]]))
    found = modes(model)
    assert found.frequency[0] > 0.0
    static = found.transfer("1", "2", [0.0])[0]
    assert static == pytest.approx(np.linalg.inv(model.stiffness)[0, 1])


@pytest.mark.parametrize(
    "make",
    [
        lambda: ShaftSegment("s", 0.1, 0.02, 0.02),
        lambda: Disc("d", -1.0),
        lambda: Gear("g", 0.0),
        lambda: assemble([Disc("a", 1.0), Coupling("k", 1.0), Coupling("k2", 1.0), Disc("b", 1.0)]),
        lambda: TorsionalModel(np.eye(2), np.array([[1.0, -1.0], [0.0, 1.0]])),
        lambda: TorsionalModel(np.diag([1.0, 0.0]), np.eye(2)),
        lambda: TorsionalModel(np.eye(2), np.array([[1.0, 2.0], [2.0, 1.0]])),
        lambda: assemble(PARTS).node("nowhere"),
        lambda: modes(assemble(PARTS)).transfer(0, 0, [0.0]),
    ],
)
def test_misuse_is_refused(make):
    with pytest.raises(InvalidInput):
        make()
