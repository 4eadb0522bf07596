"""One case on one rig for the named laws: a job of ``compare_controllers``."""

from __future__ import annotations

from ...errors import InvalidInput
from ..jobs import Job, Result
from ..scores import Score
from .cases import CASES
from .contestants import CONTESTANTS, Contestant
from .experiment import Experiment, designed, experiment, run
from .scores import METRICS, score, time_per_step


def _scored(law: Contestant, data: Experiment) -> Score:
    """Its score; ``refused`` alone where the law cannot be designed for this drive and sample time."""
    try:
        laws = designed(law, data)
    except InvalidInput:
        return {**dict.fromkeys(METRICS), "refused": 1.0}
    return {**score(run(laws, data), data), "refused": 0.0}


def score_controllers(job: Job) -> Result:
    """Scores of the named laws; a law whose set-point the case does not give has an empty one.

    A step's time is taken in the first case alone: it does not depend on the case.
    """
    name, seed, _, names = job
    data = experiment(next(c for c in CASES if c.name == name), seed)
    entries = {entry.name: entry for entry in CONTESTANTS}
    found = {}
    for law in names:
        asked = "torque" if data.work.asks_for_torque else "speed"
        if entries[law].kind == asked:
            found[law] = _scored(entries[law], data)
            if name == CASES[0].name and not found[law]["refused"]:
                found[law]["time_per_step"] = time_per_step(entries[law], data)
        else:
            found[law] = {}
    return name, seed, found
