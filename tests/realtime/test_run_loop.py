"""Law and rig as two processes: in lock-step the simulation to the last bit; no process is left, whatever happens."""

from __future__ import annotations

import os
import shutil
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.commands.loop import same_bits
from lostmotion.errors import InvalidInput
from lostmotion.realtime import exchanges, partner, run_loop
from lostmotion.realtime.partner import Partner

#: The module, which the room's function of that name hides.
loop = import_module("lostmotion.realtime.run_loop")

LAW = lm.connect(
    [lm.observers.kalman(PAPER, dt=1e-4), lm.controllers.pole_placement(PAPER, dt=1e-4, torque_limit=73.5)],
    inputs=("speed_reference", "speed_motor"),
    outputs=("torque_motor",),
)
SAMPLES = 600
STEP = {"speed_reference": np.where(np.arange(SAMPLES) < SAMPLES // 2, -2.0, 2.0)}
NEEDS_C = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler")


@pytest.fixture
def partners(monkeypatch: pytest.MonkeyPatch) -> list[Partner]:
    """All law processes that are started from now on."""
    started: list[Partner] = []

    @contextmanager
    def remembered(*args: Any, **kwargs: Any) -> Iterator[Partner]:
        with partner.partner(*args, **kwargs) as found:
            started.append(found)
            yield found

    monkeypatch.setattr(loop, "partner", remembered)
    return started


def simulated(law: Any, **given: Any) -> lm.Recording:
    return lm.rig.record(1, law=law, dt=law.dt, **given)[0]


@pytest.mark.parametrize("code", ["python", pytest.param("c", marks=NEEDS_C)])
def test_in_lock_step_it_equals_the_simulation_to_the_last_bit(code: Any, partners: list[Partner]) -> None:
    shares: list[float] = []
    run = run_loop(LAW, 1, code=code, progress=shares.append, **STEP)
    assert same_bits(run.recording, simulated(LAW, **STEP))
    assert np.ptp(run.recording["torque_motor"]) > 20.0  # the law did something
    timing = run.timing
    assert timing.round_trip.shape == (SAMPLES,) and np.all(timing.round_trip > 0.0)
    assert not timing.paced and timing.missed == 0 and timing.wake_up.size == 0
    assert shares == sorted(shares) and shares[-1] > 0.95
    assert partners[0].process.poll() == 0


def test_a_slower_law_on_another_rig_does_likewise() -> None:
    slow = lm.controllers.pi(dt=1e-3, torque_limit=40.0)
    given = {"speed_reference": STEP["speed_reference"][::4]}
    run = run_loop(slow, None, noise_seed=3, delay=2, **given)
    wanted, truth = lm.rig.record(None, law=slow, dt=1e-3, noise_seed=3, delay=2, **given)
    assert same_bits(run.recording, wanted)
    assert same_bits(run.truth.signals, truth.signals)


def test_a_stepper_that_only_watches_does_likewise() -> None:
    observer = lm.observers.sliding_mode(PAPER, dt=1e-4)
    torque = 8.0 * np.sign(np.sin(0.02 * np.arange(SAMPLES)))
    run = run_loop(observer, 1, torque_motor=torque)
    _, truth = lm.rig.record(1, law=observer, torque_motor=torque)
    for name in observer.outputs:
        assert run.truth.signals[name].tobytes() == truth.signals[name].tobytes(), name
    with pytest.raises(InvalidInput, match="no C code"):
        run_loop(observer, 1, code="c", torque_motor=torque)


class Lossy:
    """A socket that loses one datagram in thirty and sends one in seven twice."""

    def __init__(self, inner: socket.socket) -> None:
        self._inner, self._count = inner, 0

    def send(self, datagram: bytes) -> None:
        self._count += 1
        for _ in range(0 if self._count % 30 == 0 else 2 if self._count % 7 == 0 else 1):
            self._inner.send(datagram)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)


def test_lost_and_doubled_datagrams_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def lossy(*args: Any, **kwargs: Any) -> Iterator[Partner]:
        with partner.partner(*args, **kwargs) as found:
            yield replace(found, socket=Lossy(found.socket))  # type: ignore[arg-type]

    monkeypatch.setattr(loop, "partner", lossy)
    monkeypatch.setattr(exchanges, "RESEND", 0.01)
    run = run_loop(LAW, 1, **STEP)
    assert same_bits(run.recording, simulated(LAW, **STEP))
    assert run.timing.resent >= SAMPLES // 31 and run.timing.ignored > 0


def test_paced_it_counts_what_the_clock_saw() -> None:
    given = {"speed_reference": np.full(100, 1.0)}
    slow = lm.controllers.pi(dt=2e-3, torque_limit=40.0)
    timing = run_loop(slow, 1, paced=True, **given).timing
    assert timing.paced and timing.wake_up.shape == timing.round_trip.shape == (100,)
    assert np.all(timing.wake_up >= 0.0)
    there = ~np.isnan(timing.round_trip)
    assert timing.missed == 100 - np.count_nonzero(there) == timing.summary()["missed"]
    assert np.all(timing.wake_up[there] + timing.round_trip[there] <= timing.period)


def test_paced_the_outputs_before_are_held_while_the_law_does_not_answer(
    monkeypatch: pytest.MonkeyPatch, partners: list[Partner]
) -> None:
    slow = lm.controllers.pi(dt=2e-3, torque_limit=40.0)

    def stop(share: float) -> None:
        if share >= 0.5:
            os.kill(partners[0].process.pid, signal.SIGSTOP)

    monkeypatch.setattr(partner, "STOP", 0.1)
    run = run_loop(slow, 1, paced=True, progress=stop, speed_reference=np.linspace(0.0, 5.0, 100))
    assert run.timing.missed >= 45
    assert np.unique(run.recording["torque_motor"][55:]).size == 1
    assert partners[0].process.poll() is not None


def test_a_port_that_is_taken_is_named() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        port = other.getsockname()[1]
        with pytest.raises(InvalidInput, match=f"{port}, which another program uses"):
            run_loop(LAW, 1, port=port, **STEP)


def test_a_law_that_ends_or_is_silent_is_told_of(
    monkeypatch: pytest.MonkeyPatch, partners: list[Partner]
) -> None:
    monkeypatch.setattr(exchanges, "GIVE_UP", 1.0)
    monkeypatch.setattr(partner, "STOP", 0.1)
    for number, said in ((signal.SIGKILL, "ended with exit code -9"), (signal.SIGSTOP, "no answer in")):

        def hit(share: float, number: int = number) -> None:
            if share >= 0.5:
                os.kill(partners[-1].process.pid, number)

        with pytest.raises(InvalidInput, match=said):
            run_loop(LAW, 1, progress=hit, **STEP)
        assert partners[-1].process.poll() is not None


def test_ctrl_c_leaves_no_process(partners: list[Partner]) -> None:
    def interrupt(share: float) -> None:
        if share >= 0.5:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run_loop(LAW, 1, progress=interrupt, **STEP)
    assert partners[0].process.poll() is not None


def test_a_law_that_the_rig_cannot_serve_is_refused_and_its_process_ended(partners: list[Partner]) -> None:
    with pytest.raises(InvalidInput, match="twist_estimated"):
        run_loop(lm.controllers.soft_landing(PAPER, dt=1e-4, contact_speed=1.0, torque_limit=50.0), 1,
                 torque_wished=np.zeros(50))  # fmt: skip
    assert partners[0].process.poll() == 0
    with pytest.raises(InvalidInput, match="1 or more"):
        run_loop(LAW, 1, delay=0, **STEP)
