"""drivetrain.toml: exact round trips of any chain, readable text, errors."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from table_i import PAPER

from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft
from lostmotion.errors import InvalidInput
from lostmotion.io.storage.drivetrain_files import load_drivetrain, save_drivetrain

positive = st.floats(1e-12, 1e12)
level = st.floats(0.0, 1e6)


@st.composite
def chains(draw: st.DrawFn) -> Drivetrain:
    count = draw(st.integers(1, 5))
    rise = draw(level)
    stribeck = draw(st.sampled_from([(), ((0.0, rise), (0.1, rise / 3), (1 / 3, 0.0))]))
    breakaway = draw(st.sampled_from([None, 4e6]))
    coulomb = st.one_of(level, st.tuples(level, level))
    return Drivetrain(
        tuple(draw(positive) for _ in range(count)),
        tuple(
            Shaft(draw(positive), draw(level), draw(level), draw(st.sampled_from(CONTACT_LAWS)))
            for _ in range(count - 1)
        ),
        tuple(Friction(draw(coulomb), draw(level), breakaway, stribeck) for _ in range(count)),
        Actuator(*(draw(st.one_of(positive, st.just(math.inf))) if i else draw(level) for i in range(3))),
        locked=draw(st.sampled_from([None, "motor", "load"])) if count > 1 else None,
    )


@given(chains())
@settings(max_examples=100, deadline=None)
def test_round_trip_is_exact(tmp_path_factory: pytest.TempPathFactory, drivetrain: Drivetrain) -> None:
    path = tmp_path_factory.mktemp("drivetrain") / "drivetrain.toml"
    save_drivetrain(drivetrain, path)
    assert load_drivetrain(path) == drivetrain


def test_text_is_readable_and_has_units(tmp_path: Path) -> None:
    path = tmp_path / "drivetrain.toml"
    save_drivetrain(PAPER, path)
    text = path.read_text(encoding="utf-8")
    for line in (
        "[[inertia]]  # 1 of 2: motor",
        "inertia = 0.0182                   # kg m2",
        "[[shaft]]  # between inertia 1 and 2",
        "stiffness = 6285.896               # Nm/rad",
        "backlash = 0.012                   # rad, total free angle",
        'contact = "viscoelastic"           # torque law',
        "torque_limit = inf                 # Nm",
    ):
        assert line in text.splitlines()
    save_drivetrain(PAPER, tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("stiffness", "stifness", "unknown key 'stifness'.*'stiffness'"),
        ("inertia = 0.0182", "coulomb = 0.0182", "broken TOML"),
        ("inertia = 0.0182", "", r"inertia\[0\]: got no 'inertia'"),
        ("6285.896", "-1", r"Shaft\.stiffness: got -1"),
        ("6285.896", '"stiff"', r"shaft\[0\]\.stiffness: got 'stiff', expected a finite number"),
        ("6285.896", "true", r"shaft\[0\]\.stiffness: got True"),
        ("6285.896", "9" * 400, r"shaft\[0\]\.stiffness: got 9+\.\.\.9+, expected a finite"),
        ("torque_limit = inf", "torque_limit = nan", r"actuator\.torque_limit: got nan"),
        ("coulomb = 2.0", "coulomb = [2.0]", r"inertia\[1\]\.coulomb: got shape \(1,\)"),
        ("coulomb = 2.0", "stribeck = [[0.0, 1.0], [1.0]]", r"inertia\[1\]\.stribeck"),
        ("[actuator]", "locked = 3\n[actuator]", "locked: got 3, expected a text"),
        ('"viscoelastic"', '"elastic"', r"Shaft\.contact"),
        ('kind = "drivetrain"', 'kind = "law"', "kind 'law'"),
        ("schema_version = 2", "schema_version = 3", "schema_version 3"),
        ("[[shaft]]", "[shaft]", r"\[\[shaft\]\] for each"),
        ("[actuator]", "[actuatr]", "unknown key 'actuatr'"),
        ("lag = 0.0", "lagg = 0.0", "unknown key 'lagg'"),
        ("[[shaft]]", "[[shaft]]\nstiffness = 1.0\n[[shaft]]", "2 inertias, 2 shafts"),
        ("[actuator]", "[actuator", "broken TOML"),
    ],
)
def test_broken_files_are_refused(tmp_path: Path, old: str, new: str, match: str) -> None:
    path = tmp_path / "drivetrain.toml"
    save_drivetrain(PAPER, path)
    path.write_text(path.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InvalidInput, match=match) as caught:
        load_drivetrain(path)
    assert str(path) in str(caught.value)


def test_a_missing_file_is_not_called_broken(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput) as caught:
        load_drivetrain(tmp_path / "none.toml")
    assert caught.value.problem.got == "no such file"


def test_another_kind_of_file_is_said_to_be_one(tmp_path: Path) -> None:
    (tmp_path / "law.json").write_text("{}")
    with pytest.raises(InvalidInput) as caught:
        load_drivetrain(tmp_path / "law.json")
    assert "'.json'" in caught.value.problem.got and "drivetrain.toml" in caught.value.problem.remedy


def test_no_part_of_a_file_passes_as_a_whole_one(tmp_path: Path) -> None:
    path = tmp_path / "drivetrain.toml"
    save_drivetrain(PAPER, path)
    text = path.read_text(encoding="utf-8")
    for length in range(len(text) - 1):  # all but the last line's end
        path.write_text(text[:length], encoding="utf-8")
        with pytest.raises(InvalidInput):
            load_drivetrain(path)
    path.write_text(text[: text.index("[[inertia]]  # 2")], encoding="utf-8")
    with pytest.raises(InvalidInput, match=r"no last line '# end'.*half of one"):
        load_drivetrain(path)


def test_a_file_written_by_hand_needs_the_last_line_alone(tmp_path: Path) -> None:
    path = tmp_path / "drivetrain.toml"
    save_drivetrain(PAPER, path)
    lines = [line.split("#")[0] for line in path.read_text(encoding="utf-8").splitlines() if line[:1] != "#"]
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InvalidInput, match="by hand"):
        load_drivetrain(path)
    path.write_text("\r\n".join([*lines, "# end"]), encoding="utf-8")
    assert load_drivetrain(path) == PAPER
