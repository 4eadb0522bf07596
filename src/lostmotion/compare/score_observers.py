"""One case on one rig for the named observers: a job of ``compare_observers``."""

from __future__ import annotations

from ..errors import InvalidInput
from .cases import CASES
from .contestants import CONTESTANTS, Contestant
from .experiment import Experiment, experiment
from .jobs import Job, Result
from .scores import Score, refused, score

#: Length of a first run that is not timed, s (option: some samples at the longest sample time).
COMPILING = 0.02


def score_observers(job: Job) -> Result:
    """Scores of the named observers, each over the same recording."""
    name, seed, duration, names = job
    case = next(c for c in CASES if c.name == name)
    data = experiment(case, seed, float(duration or 0.0))
    entries = {entry.name: entry for entry in CONTESTANTS}
    return name, seed, {observer: _scored(entries[observer], data) for observer in names}


def _scored(observer: Contestant, data: Experiment) -> Score:
    try:
        made = observer.make(data.drivetrain, data.sensing)
    except InvalidInput:
        return refused()
    made.run(data.recording.only(*made.inputs).window(0.0, COMPILING))  # compiles: it must not be timed
    return score(made, data)
