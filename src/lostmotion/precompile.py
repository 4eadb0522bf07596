"""Compiles kernels before they are needed: each is called once on a few samples and then kept on disk.

A build does this and installs the compiled kernels with the package. On another processor the first command does it,
and shows which step of how many. Parts run at the same time, a process each::

    python -m lostmotion.precompile simulation
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from importlib import import_module
from queue import SimpleQueue
from threading import Thread

import numpy as np

from .child_process import end_python, start_python
from .drivetrain import Actuator, Drivetrain
from .errors import InvalidInput
from .kernels.compiled import is_compiled, mark_compiled
from .kernels.steppers import MODULES
from .recording import Recording
from .simulation import Sensor, simulate, simulate_batch
from .simulation.sensors import measure
from .systems import DiscreteSystem

#: A few samples, s and how many (option: any will do).
DT, SAMPLES = 1e-4, 50
PLANT = Drivetrain.two_mass(
    inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.4, backlash=0.01, coulomb=1.0, viscous=0.02,
    lag=3e-4,
)  # fmt: skip
#: A law without states.
LAW = DiscreteSystem(inputs=("speed_motor",), outputs=("torque_motor",), D=np.array([[-0.1]]), dt=DT)
COUNTS = Sensor("angle_motor", resolution=1e-3, difference=True)
#: Nm and rad/s (option: any).
TORQUE, SPEED = np.full(SAMPLES, 5.0), np.linspace(0.0, 1.0, SAMPLES)


def _open_loop() -> None:
    simulate(replace(PLANT, actuator=Actuator(rate_limit=1e5)), torque_motor=TORQUE, dt=DT, energy=True)


def _sensors() -> None:
    measure({"speed_motor": COUNTS}, {"angle_motor": SPEED}, DT, 0)


def _closed_loop() -> None:
    simulate(PLANT, law=LAW, torque_load=TORQUE, sensors={"speed_motor": COUNTS}, dt=DT)


def _batches() -> None:
    simulate_batch([PLANT], torque_motor=TORQUE, dt=DT, workers=1)


def _batches_with_a_law() -> None:
    simulate_batch([PLANT], law=LAW, torque_load=TORQUE, dt=DT, workers=1)


def _law() -> None:
    LAW.run(Recording(np.arange(SAMPLES, dtype=float) * DT, {"speed_motor": SPEED}))


def _innovations() -> None:
    from .identification.prediction_error.channel_innovations import ChannelPredictor
    from .identification.prediction_error.contact_switching.filter import ContactFilter
    from .identification.prediction_error.innovations import NAMES, Bandwidth, Predictor, to_theta
    from .identification.prediction_error.intermediate_inertia import JointPredictor

    theta, gains = to_theta([getattr(PLANT, name) for name in NAMES], DT), Bandwidth(100.0, 100.0)
    for kind in (Predictor, JointPredictor):
        kind(TORQUE, SPEED, DT, True, PLANT, skip=1).residual(theta, gains)
    ChannelPredictor(TORQUE, SPEED, DT, True, PLANT, skip=1, channels={}).residual(theta, gains)
    switching = ContactFilter(SPEED, SPEED, DT, False, 1.0, 1.0, 1, (0, SAMPLES))
    switching.run(switching.theta(PLANT.parameters()), [0])


def _estimator(kind: str) -> Callable[[], None]:
    def compile_it() -> None:
        # Its functions have one signature each, for which they are compiled here.
        import_module(MODULES[kind])

    return compile_it


#: Part → what is compiled, a step each.
PARTS: dict[str, dict[str, Callable[[], None]]] = {
    "simulation": {
        "simulation": _open_loop,
        "sensors": _sensors,
        "closed loop": _closed_loop,
        "variants": _batches,
        "closed-loop variants": _batches_with_a_law,
    },
    "identification": {"laws": _law, "innovations": _innovations},
    "observers": {kind.replace("_", " "): _estimator(kind) for kind in MODULES},
}


def compile_part(part: str) -> None:
    """Compile one part; a line on standard output for each step that is done."""
    for name, step in PARTS[part].items():
        step()
        print(name, flush=True)
    mark_compiled(part)


def compile_missing(parts: Sequence[str], progress: Callable[[int, int], None]) -> None:
    """Compile those parts that this processor has not yet, in a process each.

    Where this fails, kernels are compiled as they are called.

    Parameters
    ----------
    parts : keys of ``PARTS``
    progress : callable
        Called with the number of finished steps and the number of all.
    """
    missing = [part for part in parts if not is_compiled(part)]
    count = sum(len(PARTS[part]) for part in missing)
    finished: SimpleQueue[str | None] = SimpleQueue()
    done, running = 0, len(missing)
    with ExitStack() as stack:
        for part in missing:
            try:
                child = start_python(__name__, compile_part.__name__, part, stdin=subprocess.DEVNULL)
            except InvalidInput:
                return  # each kernel is compiled where it is first used
            stack.callback(end_python, child)
            Thread(target=_read_lines, args=(child, finished), daemon=True).start()
        while running:
            progress(done, count)
            if finished.get() is None:
                running -= 1
            else:
                done += 1


def _read_lines(child: subprocess.Popen[bytes], finished: SimpleQueue[str | None]) -> None:
    """Each line of a child's output, then None."""
    assert child.stdout is not None
    for line in child.stdout:
        finished.put(line.decode().strip())
    finished.put(None)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        compile_part(name)
