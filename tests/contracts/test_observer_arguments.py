"""What every observer must say of a wrong argument: InvalidInput with its name and a remedy, whatever its kind."""

from __future__ import annotations

import inspect
import math

import numpy as np
import pytest

from lostmotion import observers
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers.filters.tuning import Tuning
from lostmotion.observers.motor_speed.parameters import Following
from lostmotion.recording import Recording

DT = 1e-4
DRIVETRAIN = Drivetrain.two_mass(
    inertia_motor=0.03,
    inertia_load=0.1,
    stiffness=6300.0,
    damping=1.0,
    backlash=0.006,
    coulomb=2.0,
    viscous=0.02,
)
MAKERS = (
    observers.disturbance_observer,
    observers.extended_kalman,
    observers.h_infinity,
    observers.interacting_models,
    observers.kalman,
    observers.kalman_gain,
    observers.moving_horizon,
    observers.neural_network,
    observers.shaft_torque,
    observers.sliding_mode,
    observers.super_twisting,
    observers.unscented_kalman,
)
#: Not made from a drivetrain and numbers alone.
OTHERS = ("Covariances", "covariances", "speed_of_counts", "standard_deviations")

#: Options that travel together, by the name of their keyword argument.
OPTIONS = {"tuning": Tuning, "following": Following}

NO_NUMBER = ("1 ms", True, [1e-3], math.nan, 10**400)
NO_MAPPING = (5.0, "speed_motor", 0, ["speed_motor"], {5: 1.0}, {"wild": 1.0})
BAD = {
    "Drivetrain": (None, "x", 5.0, {"stiffness": 6300.0}),
    "bool": ("no", None, 1, np.array([True, False])),
    "float": (None, *NO_NUMBER),
    "float | None": NO_NUMBER,
    "Sequence[str]": (None, 5, "speed_motor", (), ("wild",), ("speed_motor",) * 2, [["speed_motor"]], {5: 6}),
    "Mapping[str, float] | None": NO_MAPPING,
    "float | Mapping[str, float] | None": (*NO_NUMBER, *NO_MAPPING[1:], {"speed_motor": "low"}),
}
#: A name that each mapping knows: its value may be wrong, too.
KNOWN = {
    "weights": "twist", "process_covariance": "twist", "drift": "backlash", "uncertainty": "backlash",
    "process_torque": "motor",
}  # fmt: skip


def _kinds(make):
    """Annotation of each argument, those of its options among them."""
    found = {name: p.annotation for name, p in inspect.signature(make).parameters.items()}
    for name, options in OPTIONS.items():
        if found.pop(name, None):
            found |= {
                n: getattr(kind, "__forward_arg__", kind) for n, kind in options.__annotations__.items()
            }
    return found


def _wrong():
    for make in MAKERS:
        for name, kind in _kinds(make).items():
            values = list(BAD[kind])
            if kind == "Mapping[str, float] | None":
                values += [
                    {KNOWN.get(name, "speed_motor"): value} for value in ("low", None, -1.0, *NO_NUMBER)
                ]
            for value in values:
                yield pytest.param(make, name, value, id=f"{make.__name__}-{name}-{str(value)[:20]}")


def _good(make):
    first = {"stiffness": 110.0} if make is observers.shaft_torque else {"drivetrain": DRIVETRAIN}
    return first if make is observers.kalman_gain else {**first, "dt": DT}


def test_every_observer_is_here():
    assert {make.__name__ for make in MAKERS} == set(observers.__all__) - set(OTHERS)


@pytest.mark.parametrize("make, name, value", list(_wrong()))
def test_a_wrong_argument_is_told_by_its_name_with_a_remedy(make, name, value):
    with pytest.raises(InvalidInput) as told:
        make(**{**_good(make), name: value})
    problem = told.value.problem
    assert name in problem.where
    assert problem.got and problem.expected and problem.remedy


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_a_number_and_a_flag_may_be_numpys(make):
    given = _good(make)
    if "dt" in given:
        given["dt"] = np.float64(DT)
    if "speed_from_counts" in _kinds(make):
        given["speed_from_counts"] = np.bool_(True)
    make(**given)


@pytest.mark.parametrize("make", [m for m in MAKERS if "sensor_noise" in _kinds(m)], ids=lambda m: m.__name__)
def test_all_steppers_take_the_same_sensor_noise(make):
    told = make(DRIVETRAIN, dt=DT, sensor_noise={"speed_motor": 0.1})
    assert not np.array_equal(told.parameters, make(DRIVETRAIN, dt=DT).parameters)
    if _kinds(make)["sensor_noise"].startswith("float"):
        assert np.array_equal(told.parameters, make(DRIVETRAIN, dt=DT, sensor_noise=0.1).parameters)
    with pytest.raises(InvalidInput, match=r"sensor_noise.*twist.*Measure them, or drop them"):
        make(DRIVETRAIN, dt=DT, sensor_noise={"speed_motor": 0.1, "twist": 1e-5})


RECORDING = Recording(
    time=DT * np.arange(20000), signals=dict.fromkeys(("torque_motor", "speed_motor"), np.zeros(20000))
)


@pytest.mark.parametrize(
    "changed",
    [{"drivetrain": "x"}, {"measured": "speed_motor"}, {"measured": 5}, {"speed_from_counts": "no"}],
)
def test_covariances_tell_a_wrong_argument(changed):
    (name,) = changed
    with pytest.raises(InvalidInput, match=name):
        observers.covariances(**{"recording": RECORDING, "drivetrain": DRIVETRAIN, **changed})


@pytest.mark.parametrize(
    "changed",
    [
        {"observer": "x"},
        {"observer": observers.extended_kalman(DRIVETRAIN, dt=DT)},
        {"process_covariance": 5.0},
        {"process_covariance": {"twist": "low"}},
        {"measurement_covariance": None, "process_covariance": {"wild": 1.0}},
        {"measurement_covariance": {"speed_motor": None}},
    ],
)
def test_deviations_tell_a_wrong_argument(changed):
    good = {"process_covariance": {"speed_motor": 1.0}, "measurement_covariance": {"speed_motor": 1e-6}}
    with pytest.raises(InvalidInput, match="|".join(changed)):
        observers.standard_deviations(
            **{"observer": observers.kalman(DRIVETRAIN, dt=DT), "data": RECORDING, **good, **changed}
        )
