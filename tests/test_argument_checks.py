"""Arguments against annotations: what each kind takes, and that Python's own complaints stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import ArrayLike

from lostmotion.argument_checks import Limit, checks_arguments, not_negative
from lostmotion.errors import InvalidInput


@checks_arguments
def measure(
    number: float = 0.0,
    limit: float = float("inf"),
    count: int = 1,
    flag: bool = False,
    *,
    name: str | None = None,
    file: str | Path = "",
    row: ArrayLike = (),
    band: tuple[float, float] | None = None,
    names: Sequence[str] = (),
    levels: tuple[float, ...] = (),
    sizes: Mapping[str, float] | None = None,
    method: Literal["a", "b"] = "a",
    pole: complex = 0.0,
    largest: Limit | None = None,
    anything: Any = None,
    unknown: tuple[Curve, ...] = (),  # noqa: F821
    **others: ArrayLike,
) -> str:
    """Its own words."""
    return "measured"


GOOD: list[dict[str, Any]] = [
    {"number": 1}, {"number": np.float32(1.0)}, {"number": np.array(1.0)}, {"limit": float("inf")}, {"limit": -1e3},
    {"count": np.int64(3)}, {"flag": np.True_}, {"name": None}, {"name": "x"}, {"file": Path("x")}, {"row": [1, 2]},
    {"row": 3.0}, {"row": np.full(3, np.nan)}, {"band": (1, 2)}, {"band": [1.0, 2.0]}, {"band": np.ones(2)},
    {"band": None}, {"names": ["a"]}, {"levels": np.ones(3)}, {"levels": []}, {"sizes": {"a": 1}}, {"method": "c"},
    {"pole": 1 + 1j}, {"anything": object()}, {"unknown": (object(),)}, {"torque_motor": [1.0]},
    {"largest": float("inf")}, {"row": np.ma.masked_array([1.0, 2.0])},
]  # fmt: skip
BAD: list[dict[str, Any]] = [
    {"number": "1"}, {"number": True}, {"number": None}, {"number": float("nan")}, {"number": float("inf")},
    {"number": 1e101}, {"number": 10**400}, {"number": 1j}, {"number": [1.0]}, {"limit": float("nan")}, {"limit": "x"},
    {"count": 1.0}, {"count": True}, {"count": 2**63}, {"flag": 1}, {"flag": "no"}, {"name": 3}, {"file": b"x"},
    {"row": ["a"]}, {"row": None}, {"row": [[1], [1, 2]]}, {"row": 1j}, {"row": [10**400]}, {"band": (1, 2, 3)},
    {"band": (1, None)}, {"band": 3}, {"band": "ab"}, {"names": "ab"}, {"names": [1]}, {"names": {"a": 1}},
    {"row": np.ma.masked_array([1.0, 2.0], [False, True])},
    {"levels": 1.0}, {"levels": ["a"]}, {"sizes": {"a": "b"}}, {"sizes": {1: 1.0}}, {"sizes": [1]}, {"method": 1},
    {"pole": "x"}, {"pole": complex("nan")}, {"unknown": 3}, {"torque_motor": "x"},
    {"largest": float("nan")},
]  # fmt: skip


@pytest.mark.parametrize("arguments", GOOD, ids=lambda one: next(iter(one)))
def test_what_is_taken(arguments: dict[str, Any]) -> None:
    assert measure(**arguments) == "measured"


@pytest.mark.parametrize("arguments", BAD, ids=lambda one: next(iter(one)))
def test_what_is_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput) as caught:
        measure(**arguments)
    problem = caught.value.problem
    assert problem.where.split("[")[0] == f"measure.{next(iter(arguments))}"
    assert problem.got and problem.expected and problem.remedy


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"levels": (1.0, "x")}, r"measure\.levels\[1\]: got 'x', expected a finite number"),
        ({"sizes": {"a": 1.0, "b": None}}, r"measure\.sizes\['b'\]: got None"),
        ({"names": ["a", 3]}, r"measure\.names\[1\]: got 3, expected a text"),
    ],
    ids=["list", "mapping", "texts"],
)
def test_the_part_that_does_not_fit_is_named(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        measure(**arguments)


def test_arguments_in_turn_are_told_by_their_name() -> None:
    with pytest.raises(InvalidInput, match=r"measure\.limit: got 'x', expected a number, or infinity"):
        measure(1.0, "x")  # type: ignore[arg-type]


@pytest.mark.parametrize("arguments", [(1, 2, 3, True, 5), ()], ids=["too many", "missing"])
def test_python_tells_the_rest(arguments: tuple[Any, ...]) -> None:
    @checks_arguments
    def needs(number: float, /) -> None: ...

    with pytest.raises(TypeError):
        measure(*arguments) if arguments else needs()  # type: ignore[call-arg]


def test_a_class_is_checked_where_it_is_made_and_stays_itself() -> None:
    @checks_arguments
    @dataclass(frozen=True)
    class Thing:
        size: float
        names: tuple[str, ...] = ()

    assert Thing(1.0) == Thing(size=1.0) and Thing.__doc__ and measure.__doc__ == "Its own words."
    with pytest.raises(
        InvalidInput, match=r"Thing\.names: got 'ab', expected a list or tuple \(a text each\)"
    ):
        Thing(1.0, "ab")  # type: ignore[arg-type]


@pytest.mark.parametrize(("value", "positive"), [(-1.0, False), (0.0, True), (float("inf"), False)])
def test_not_negative(value: float, positive: bool) -> None:
    assert not_negative("x", 0) == 0.0 and not_negative("x", 2, positive=True) == 2.0
    with pytest.raises(InvalidInput, match="Check the sign"):
        not_negative("x", value, positive)
