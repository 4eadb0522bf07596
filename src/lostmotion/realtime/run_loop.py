"""run_loop: a law in its own process, in the loop of the virtual rig."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from ..recording import Recording
from ..rig import Rig, Truth, record
from ..systems import DiscreteSystem, Stepper
from .exchanges import LockStep, Paced, short_timer_slack
from .partner import partner
from .remote_law import RemoteLaw, raised_after
from .timing import Timing

Law = DiscreteSystem | Stepper


@dataclass(frozen=True, eq=False)
class LoopRun:
    """What the rig's sensors showed, the truth, and the times of the two processes."""

    recording: Recording
    truth: Truth
    timing: Timing


@checks_arguments
def run_loop(
    law: DiscreteSystem | Stepper,
    rig: int | Rig | None = 1,
    *,
    paced: bool = False,
    code: Literal["c", "python"] = "python",
    port: int = 0,
    delay: int = 1,
    noise_seed: int = 0,
    progress: Callable[[float], None] | None = None,
    **signals: ArrayLike,
) -> LoopRun:
    """Run a law as a process of its own against the virtual rig, over UDP of this machine alone.

    In lock-step each waits for the other: the result equals ``rig.record(rig, law=law, …)`` bit for bit. Paced, the
    rig sends at each tick of the clock, and holds the law's outputs where the new ones are not there at the next tick.

    Parameters
    ----------
    law : DiscreteSystem or Stepper
    rig : int, Rig or None
        As in ``rig.record``.
    paced : bool
    code : {"c", "python"}
        What the law's process runs: the exported C, which needs a C compiler and a DiscreteSystem, or what ``simulate``
        runs.
    port : int
        Of the rig; 0: a free one.
    delay : int
        Samples from the law's step until its torque acts, 1 or more.
    noise_seed : int
        Of the rig's sensors.
    progress : callable, optional
        Called with the share that is done, 0 … 1.
    **signals : (n,) arrays
        Set-points, such as ``speed_reference``, or ``torque_motor`` for a law that only watches, at the law's sample
        time; they decide how long the run is.

    Returns
    -------
    LoopRun

    Raises
    ------
    InvalidInput
        If the port is taken, there is no compiler for ``code="c"``, the law's process ends or does not answer in time,
        or ``rig.record`` refuses an argument.
    """
    if delay < 1:
        raise InvalidInput(
            "run_loop.delay", f"{delay}", "1 or more: the answer takes a part of the sample", "1 is usual."
        )
    if code == "c" and isinstance(law, Stepper):
        raise InvalidInput(
            "run_loop.code", f"'c' for the stepper {law.name}", "'python'", "A stepper has no C code."
        )
    given: dict[str, Any] = dict(signals)
    samples = max((np.size(values) for values in given.values()), default=0)
    with partner(law, exported=code == "c", port=port) as process:
        exchange = (
            Paced(process, samples, progress, law.dt) if paced else LockStep(process, samples, progress)
        )
        remote = RemoteLaw.of(law, exchange)
        with raised_after(remote), short_timer_slack() if paced else nullcontext():
            recording, truth = record(rig, law=remote, dt=law.dt, delay=delay, noise_seed=noise_seed, **given)
        return LoopRun(recording, truth, exchange.timing(law.dt))
