"""Jobs in processes: whoever leaves early does not wait for those that run."""

from __future__ import annotations

import time

import pytest

from lostmotion.compare.jobs import run_jobs


def slow_but_the_first(job):
    time.sleep(0.0 if job[1] == 1 else 20.0)
    return job[0], job[1], {}


@pytest.mark.parametrize("interrupt", [KeyboardInterrupt, GeneratorExit])
def test_leaving_ends_the_jobs_that_run(interrupt):
    results = run_jobs(slow_but_the_first, [("nominal", seed, 3.0, ()) for seed in range(1, 7)], 2)
    assert next(results) == ("nominal", 1, {})
    before = time.monotonic()
    with pytest.raises(interrupt):
        results.throw(interrupt)
    assert time.monotonic() - before < 5.0
