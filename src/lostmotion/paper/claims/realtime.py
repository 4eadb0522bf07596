"""The claim of section VI that the law runs on the test rig: here as a process of its own, against the virtual rig."""

from __future__ import annotations

import numpy as np

from ... import signals
from ...realtime import run_loop
from ...recording import Recording
from ...rig import Rig
from ...systems import DiscreteSystem
from .. import published
from ..claim import Claim, judged
from ..experiments import LENGTH, STEP_NOISE, Experiments, placed_law


def claims(e: Experiments) -> list[Claim]:
    return [lock_step(lock_step_run(e.rig, placed_law(e.model)), e.placed_step.recording)]


def lock_step_run(rig: Rig, law: DiscreteSystem) -> Recording:
    """The step of the set-point, law and rig as two processes that wait for each other, over UDP of this machine."""
    reference = signals.steps((published.STEP_TIME,), (published.LOW, published.HIGH), LENGTH, published.DT)
    return run_loop(law, rig, noise_seed=STEP_NOISE, speed_reference=reference).recording


def lock_step(run: Recording, simulated: Recording) -> Claim:
    """Two processes in lock-step against one simulation, bit by bit."""
    same = {name: bool(np.array_equal(run[name], simulated[name])) for name in simulated.names}
    return Claim(
        name="observer and controller run beside the rig",
        says="The observer and the pole placement controller were successfully implemented at the test rig.",
        where="section VI",
        quantity=f"signals that equal the simulation bit for bit, of {len(same)}",
        value=(float(sum(same.values())),),
        tolerance="all",
        verdict=judged(*same.values()),
        sentence=f"Law and rig as two processes in lock-step: in {len(simulated)} samples of "
        f"{1e3 * published.DT:g} ms {sum(same.values())} of {len(same)} signals equal the simulation bit for "
        "bit. How punctual a machine is tells lostmotion loop --paced; nothing is claimed of that.",
    )
