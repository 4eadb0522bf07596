"""Drivetrain, Shaft, Friction, Actuator: derived values of Table I, and what they refuse."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import PARAMETER_UNITS, Actuator, Drivetrain, Friction, Gear, Shaft


def test_derived_values_of_table_i():
    plant = Drivetrain.two_mass(**TABLE_I)
    assert plant.zero_frequency == pytest.approx(37.87, abs=0.005)
    assert plant.pole_frequency == pytest.approx(100.91, abs=0.005)
    assert plant.damping_ratio == pytest.approx(0.02002, abs=5e-6)
    assert plant.inertia_total == pytest.approx(0.1292, abs=1e-15)


def test_linear_matrices_have_the_papers_eigenfrequency():
    a, b = Drivetrain.two_mass(**{**TABLE_I, "viscous": 0.0}).linear()
    oscillation = max(np.linalg.eigvals(a), key=abs)
    assert abs(oscillation) / (2.0 * math.pi) == pytest.approx(100.91, abs=0.01)
    assert b.tolist() == [[0.0], [1.0 / 0.0182], [0.0]]


def test_parameters_round_trip():
    plant = Drivetrain.two_mass(
        **TABLE_I, coulomb_motor=0.3, viscous_motor=0.01, lag=1e-3, contact="dead_zone"
    )
    parameters = plant.parameters()
    assert tuple(parameters) == tuple(PARAMETER_UNITS)
    assert Drivetrain.two_mass(**parameters, contact="dead_zone") == plant
    assert plant.with_parameters(backlash=0.02).backlash == 0.02
    assert plant.with_contact("physical").contact == "physical"
    assert plant.with_parameters(lag=0.0).actuator.lag == 0.0


def test_with_parameters_keeps_what_is_not_named():
    plant = Drivetrain(
        (0.02, 0.1),
        (Shaft(6000.0, 0.3, 0.01, "clipped"),),
        (Friction((0.2, 0.1)), Friction((2.0, 1.5), 0.02, 3.0, ((0.0, 0.3), (1.0, 0.0)))),
        Actuator(1e-3, 70.0, 500.0),
        locked="load",
    )
    assert plant.with_parameters() == plant
    changed = plant.with_parameters(backlash=0.02, viscous=0.03, torque_limit=50.0)
    assert changed == replace(
        plant,
        shafts=(replace(plant.shaft, backlash=0.02),),
        frictions=(plant.frictions[0], replace(plant.frictions[1], viscous=0.03)),
        actuator=Actuator(1e-3, 50.0, 500.0),
    )
    assert plant.with_parameters(coulomb_motor=0.3).frictions == (Friction(0.3), plant.frictions[1])
    assert plant.with_parameters(coulomb=2.5).frictions[1] == replace(plant.frictions[1], coulomb=2.5)
    too_low = plant.with_parameters(coulomb=2.8).frictions[1]  # 2.8 + 0.3 Nm exceed the breakaway level
    assert too_low == replace(plant.frictions[1], coulomb=2.8, breakaway=None)


def test_chain_has_no_two_mass_names():
    chain = Drivetrain((1.0, 1.0, 1.0), (Shaft(1.0), Shaft(1.0)))
    for name in ("stiffness", "inertia_load", "coulomb", "shaft"):
        with pytest.raises(lm.InvalidInput, match="two-mass"):
            getattr(chain, name)


def test_friction_curve():
    friction = Friction((0.5, 0.3), viscous=0.1, stribeck=((0.0, 0.4), (1.0, 0.0)))
    assert friction.level_at_rest == (0.9, 0.7)
    assert friction.torque(0.5) == pytest.approx(0.5 + 0.2 + 0.05)
    assert friction.torque(-2.0) == pytest.approx(-(0.3 + 0.2))
    assert friction.torque(0.0) == 0.0
    assert friction.sticks
    assert not Friction(viscous=1.0).sticks


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: Drivetrain.two_mass(**{**TABLE_I, "inertia_motor": -0.1}), r"inertia"),
        (lambda: Drivetrain.two_mass(**{**TABLE_I, "stiffness": 0.0}), "stiffness"),
        (lambda: Drivetrain.two_mass(**{**TABLE_I, "backlash": math.nan}), "backlash"),
        (lambda: Drivetrain.two_mass(**{**TABLE_I, "damping": math.inf}), "damping"),
        (lambda: Drivetrain.two_mass(**TABLE_I, contact="springy"), "contact"),
        (lambda: Drivetrain.two_mass(**TABLE_I).with_parameters(stifness=1.0), "with_parameters"),
        (lambda: Drivetrain((1.0, 1.0)), "Drivetrain"),
        (lambda: Drivetrain(()), "Drivetrain"),
        (lambda: Drivetrain((1.0,), frictions=(Friction(), Friction())), "Drivetrain"),
        (lambda: Friction(coulomb=-1.0), "coulomb"),
        (lambda: Friction(coulomb=(1.0, -1.0)), r"coulomb\[1\]"),
        (lambda: Friction(coulomb=2.0, breakaway=1.0), "breakaway"),
        (lambda: Friction(stribeck=((0.1, 1.0), (1.0, 0.0))), "stribeck"),
        (lambda: Friction(stribeck=((0.0, 1.0), (1.0, 0.5))), "stribeck"),
        (lambda: Friction(stribeck=((0.0, 1.0), (1.0, 0.5), (1.0, 0.0))), "stribeck"),
        (lambda: Actuator(lag=-1.0), "lag"),
        (lambda: Actuator(torque_limit=0.0), "torque_limit"),
        (lambda: Actuator(rate_limit=-1.0), "rate_limit"),
        (lambda: Actuator(torque_limit=math.nan), "torque_limit"),
    ],
)
def test_impossible_drivetrains_are_refused(make, where):
    with pytest.raises(lm.InvalidInput, match=where):
        make()


def test_gear_referred_and_back():
    behind = Drivetrain(
        (2.0, 3.0), (Shaft(1e4, 2.0, 0.01),), (Friction((5.0, 4.0), 0.1), Friction(1.0, breakaway=2.0))
    )
    gear = Gear(10.0)
    seen = gear.refer(behind)
    assert seen.inertias == pytest.approx((0.02, 0.03))
    assert seen.shafts[0].stiffness == pytest.approx(100.0)
    assert seen.shafts[0].backlash == pytest.approx(0.1)
    assert seen.frictions[0].coulomb == pytest.approx((0.5, 0.4))
    back = gear.refer_back(seen)
    assert back.inertias == pytest.approx(behind.inertias)
    assert back.frictions[1].breakaway == pytest.approx(2.0)
    assert Gear(-10.0).refer(behind).frictions[0].coulomb == pytest.approx((0.4, 0.5))
    with pytest.raises(lm.InvalidInput, match="Gear"):
        Gear(0.0)


def test_gear_keeps_kinetic_energy_power_and_frequency():
    """A chain behind a gear, simulated referred and as it is, driven by the same torque through the gear."""
    behind = Drivetrain((2.0, 3.0), (Shaft(1e4, 2.0, 0.01),), (Friction(), Friction(5.0, 0.1)))
    gear = Gear(8.0)
    torque = 400.0 * np.sign(np.sin(np.arange(2000) * 0.01))
    direct = lm.simulate(behind, torque_motor=torque, dt=1e-4, energy=True)
    seen = lm.simulate(gear.refer(behind), torque_motor=torque / 8.0, dt=1e-4, energy=True)
    for name in ("speed_load", "twist", "torque_shaft", "energy_stored", "energy_dissipated"):
        np.testing.assert_allclose(gear.behind(name, seen[name]), direct[name], rtol=0.0, atol=1e-9)


def test_gear_scales_a_signal_by_its_unit():
    values, gear = np.array([6.0]), Gear(-2.0)
    for name in ("friction_load", "friction_load_estimated", "torque_shaft_2", "torque_3"):
        assert gear.behind(name, values) == -12.0, name
    for name in ("speed_2", "twist_1", "angle_load", "speed_load_estimated"):
        assert gear.behind(name, values) == -3.0, name
    assert gear.behind("energy_input", values) == 6.0
    with pytest.raises(lm.InvalidInput, match="behind"):
        gear.behind("input_fault", values)


def test_gear_joins_two_sides():
    motor = Drivetrain((0.01,), actuator=Actuator(lag=1e-3))
    output = Drivetrain((2.0, 3.0), (Shaft(1e4),))
    chain = Gear(10.0).join(motor, Shaft(2e4, 1.0, 0.005), output)
    assert chain.inertias == pytest.approx((0.01, 0.02, 0.03))
    assert [s.stiffness for s in chain.shafts] == pytest.approx([200.0, 100.0])
    assert chain.shafts[0].backlash == pytest.approx(0.05)
    assert chain.actuator.lag == 1e-3


@pytest.mark.parametrize(
    "made",
    [
        Drivetrain.two_mass(**TABLE_I),
        Drivetrain.two_mass(**TABLE_I, lag=3e-4, torque_limit=73.5, coulomb_motor=0.3),
        lm.rig.nominal_rig().drivetrain,
        Drivetrain((1.0,)),
        Drivetrain((1.0, 2.0), (Shaft(5.0),), locked="load"),
    ],
    ids=["table I", "actuator", "chain", "one inertia", "locked"],
)
def test_the_repr_is_short_and_makes_the_same_drivetrain_again(made):
    assert len(repr(made).splitlines()) <= 5
    names = {"Drivetrain": Drivetrain, "Shaft": Shaft, "Friction": Friction, "Actuator": Actuator}
    assert eval(repr(made), names) == made


def test_the_repr_leaves_out_what_is_by_default():
    assert repr(Shaft(5.0)) == "Shaft(stiffness=5.0)"
    assert repr(Friction((1.0, 2.0), viscous=0.1)) == "Friction(coulomb=(1.0, 2.0), viscous=0.1)"
    assert repr(Actuator()) == "Actuator()"
    assert repr(Drivetrain((1.0, 2.0), (Shaft(5.0),))) == (
        "Drivetrain(inertias=(1.0, 2.0),\n  shafts=(Shaft(stiffness=5.0),))"
    )


def test_html_has_a_row_for_each_part():
    chain = replace(lm.rig.nominal_rig().drivetrain, locked="load")
    shown = chain._repr_html_().replace("\u00a0", " ")
    assert shown.count("<tr>") == 4 + 3 + 1
    for text in (
        "inertia 4 (load)",
        "7359 Nm/rad",
        "backlash 12 mrad, physical",
        "held, coulomb 2 Nm",
        "Stribeck 0.3 Nm",
    ):
        assert text in shown
    assert "lag 300 µs, torque limit 73.5 Nm" in shown
    uneven = replace(
        Drivetrain.two_mass(**TABLE_I), frictions=(Friction(), Friction((1.0, 2.0), breakaway=3.0))
    )
    assert "coulomb 1 Nm forwards, 2 Nm backwards, breakaway 3 Nm" in uneven._repr_html_().replace(
        "\u00a0", " "
    )
