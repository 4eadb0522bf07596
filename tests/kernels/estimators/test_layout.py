"""The numbers of saved estimators: their order stays."""

from __future__ import annotations

import pytest

from lostmotion.kernels.estimators import layout

#: Where each number stands in the files of schema version 1.
PARAMETERS = {
    "transition": 0, "lead_middle": 40, "lead": 41, "stiffness": 42, "damping": 43, "viscous": 44, "coulomb_motor": 45,
    "ratio_plus": 46, "ratio_minus": 47, "rest_motor": 48, "rest_load": 49, "substeps": 50, "counted": 51,
    "torque_bound": 52, "gate": 53, "hold": 54, "dt": 55, "x0": 56, "P0": 67, "Q": 78, "kind": 89, "scale": 93,
    "R": 97, "mismatch": 101, "still": 105, "sensors": 109, "coulomb_bound": 110, "frozen_hold": 111,
    "inertia_motor": 112, "inertia_load": 113, "eigenmode_share": 114, "eigenmode_rate": 115, "torque_missing": 116,
    "largest_deviation": 117, "side_unknown": 118,
}  # fmt: skip


def test_the_parameters_of_saved_laws_stand_where_they_stood():
    assert {name: layout.place(layout.PARAMETERS, name) for name in layout.PARAMETERS.names} == PARAMETERS


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("PARAMETERS", 119), ("HORIZON_PARAMETERS", 121), ("INTERACTING_PARAMETERS", 123), ("SLIDING_PARAMETERS", 130),
        ("TWISTING_PARAMETERS", 133), ("NETWORK_PARAMETERS", 150), ("TRACKING", 167), ("INTERACTING", 200),
        ("SPEED_OBSERVER", 17), ("TWISTING", 19), ("NETWORK", 122), ("NODE", 22),
    ],
)  # fmt: skip
def test_no_record_has_changed_its_size(name, size):
    assert layout.size(getattr(layout, name)) == size
