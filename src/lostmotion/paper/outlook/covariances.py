"""Do covariances from data beat the educated guess?"""

from __future__ import annotations

from ...observers import covariances
from .. import published
from ..claims.observers import error
from ..experiments import STEP_NOISE, Experiments, Identified, observer, pi_law, speed_step
from .answer import Answer

#: Seed of the noise in the recording that the covariances are computed from; judged on another one (numerics).
LEARNED = STEP_NOISE + 100


def from_data(e: Experiments, identified: Identified) -> Answer:
    """Q and R of the largest likelihood of the innovations, against equation (8)."""
    model = identified.found.drivetrain
    learned = speed_step(e.rig, pi_law(), noise_seed=LEARNED).recording
    found = covariances(learned.only("torque_motor", "speed_motor"), model)
    guess = error(observer(model), e.pi_step)
    computed = error(found.observer(model, dt=published.DT, speed_from_counts=True), e.pi_step)
    better = "better" if computed < guess else "no better"
    return Answer(
        question="Covariance matrices of process and observation noise could be calculated instead of guessed.",
        text=f"They are {better} here: with the covariances under which a step under PI control is most "
        f"likely the load speed of Observer 1 is {100 * computed:.3f} % of its range off, with those of "
        f"equation (8) {100 * guess:.3f} %. The likelihood looks at the motor speed alone, and what the "
        "model leaves out on the motor's side is not noise on the load.",
        page="observers.md",
        numbers={
            "error with covariances from data, % of range": 100.0 * computed,
            "error with equation (8), % of range": 100.0 * guess,
        },
    )
