"""The core of every result: what it shows to a person, and what it gives to other programs."""

from __future__ import annotations

import json

import pytest

from lostmotion.errors import Problem
from lostmotion.identification import Estimates
from lostmotion.identification.statistics.estimates import UNITS

FOUND = Estimates(
    values={
        "backlash": 0.012131,
        "stiffness": 6285.896,
        "damping": None,
        "damping_ratio": 0.04,
        "coulomb": 2.0,
    },
    intervals={"backlash": (0.01205, 0.01221), "stiffness": (6200.0, 6371.0), "damping_ratio": (0.03, 0.05)},
    sources={
        "backlash": "identified",
        "stiffness": "identified",
        "damping": "not excited",
        "damping_ratio": "identified",
        "coulomb": "nameplate",
    },
    problems=(Problem("warning", "damping", "a <b> & more", "excitation", "Record more torque."),),
)


def test_the_summary_is_a_line_for_each_value_and_each_problem() -> None:
    assert FOUND.summary().splitlines() == [
        "Estimates: 3 of 5 identified, 1 problem",
        "  backlash       0.01213  rad       0.01205 … 0.01221  ± 0.66 %  identified",
        "  stiffness      6286     Nm/rad    6200 … 6371        ± 1.4 %   identified",
        "  damping        –        Nm s/rad                               not excited",
        "  damping_ratio  0.040              0.030 … 0.050      ± 25 %    identified",
        "  coulomb        2.000    Nm                                     nameplate",
        "  warning: damping: got a <b> & more, expected excitation. Record more torque.",
    ]


def test_the_repr_is_short_and_says_what_is_not_told() -> None:
    assert repr(FOUND).splitlines() == [
        "Estimates: 3 of 5 identified, 1 problem",
        "  backlash 0.01213 rad, stiffness 6286 Nm/rad, damping not excited, damping_ratio 0.040,",
        "  coulomb 2.000 Nm",
    ]


def test_html_shows_the_same_and_escapes_it() -> None:
    shown = FOUND._repr_html_()
    assert shown.count("<tr>") == 6
    assert ">6200 … 6371<" in shown and ">not excited<" in shown
    assert "a &lt;b&gt; &amp; more" in shown and "<b> &" not in shown


def test_the_table_is_that_of_results_json() -> None:
    assert FOUND.table()["stiffness"] == {
        "value": 6285.896,
        "low": 6200.0,
        "high": 6371.0,
        "unit": "Nm/rad",
        "source": "identified",
    }
    assert FOUND.table()["damping"]["value"] is FOUND.table()["damping"]["low"] is None


def test_as_dict_is_json() -> None:
    again = json.loads(json.dumps(FOUND.as_dict(), allow_nan=False))
    assert again["values"]["damping"] is None and again["intervals"]["backlash"] == [0.01205, 0.01221]
    assert again["sources"]["coulomb"] == "nameplate" and again["units"]["backlash"] == "rad"
    assert again["problems"][0]["remedy"] == "Record more torque."


def test_nothing_in_it_can_be_changed() -> None:
    for mapping in (FOUND.values, FOUND.intervals, FOUND.sources, FOUND.units, UNITS):
        with pytest.raises(TypeError):
            mapping["backlash"] = 1.0  # type: ignore[index]
