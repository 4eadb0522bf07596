"""Names of cases and observers as they are typed."""

from __future__ import annotations

import pytest

from lostmotion.compare import CASES, CONTESTANTS
from lostmotion.compare.names import known_names, plain
from lostmotion.errors import InvalidInput

CASE_NAMES = [case.name for case in CASES]
OBSERVER_NAMES = [entry.name for entry in CONTESTANTS]


@pytest.mark.parametrize(
    "typed, known, meant",
    [
        ("inertia_load -20 %", CASE_NAMES, "inertia_load −20 %"),
        ("Inertia_Load -20%", CASE_NAMES, "inertia_load −20 %"),
        ("inertia_load +20 %", CASE_NAMES, "inertia_load +20 %"),
        ("NOMINAL", CASE_NAMES, "nominal"),
        ("Hinfinity", OBSERVER_NAMES, "H∞"),
        ("H infinity", OBSERVER_NAMES, "H∞"),
        ("h infinity, load torque", OBSERVER_NAMES, "H∞, load torque"),
        ("observer 1", OBSERVER_NAMES, "Observer 1"),
    ],
)
def test_what_a_keyboard_has_is_enough(typed, known, meant):
    assert known_names("observers", "cases", [typed], known) == [meant]


@pytest.mark.parametrize("known", [CASE_NAMES, OBSERVER_NAMES])
def test_no_two_names_are_typed_alike_and_all_in_ascii(known):
    typed = [plain(name) for name in known]
    assert len(set(typed)) == len(known)
    assert all(word.isascii() for word in typed)
    assert known_names("observers", "cases", known, known) == known


@pytest.mark.parametrize(
    "typed, near", [("inertia_laod -20 %", "'inertia_load −20 %'"), ("nominl", "'nominal'")]
)
def test_the_nearest_name_is_suggested(typed, near):
    with pytest.raises(InvalidInput, match=f"Did you mean {near}.*--list"):
        known_names("observers", "cases", ["sticking", typed], CASE_NAMES)


@pytest.mark.parametrize("given", ["nominal", [], None, 5, [5], ["wild"]])
def test_what_is_no_list_of_names_is_told_so(given):
    with pytest.raises(InvalidInput, match=r"compare_observers\.cases.*a list of names of cases"):
        known_names("observers", "cases", given, CASE_NAMES)
