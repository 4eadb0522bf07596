"""Errors come back whole from another process, as a batch in processes raises them."""

from __future__ import annotations

import pickle

from lostmotion.errors import InputProblems, InvalidInput, Problem


def test_errors_pass_between_processes() -> None:
    one = InvalidInput("where", "got", "expected", "Remedy.")
    assert pickle.loads(pickle.dumps(one)).problem == one.problem
    many = InputProblems([one.problem, Problem("warning", "a", "b", "c", "d")])
    assert pickle.loads(pickle.dumps(many)).problems == many.problems
