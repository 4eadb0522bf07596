"""How well a recording can tell the parameters at all: Cramér–Rao half widths with the true structure.

The recording is cut in windows. In each the initial state is unknown, and the sensitivities of what the sensor shows
to parameters and initial state come from the exact simulator, by differences. With F the information of the parameters
that is left when initial states and nuisance parameters are taken out, no unbiased estimator that forgets between the
windows has a smaller 95 % half width than 1.96·√(F⁻¹)ᵢᵢ (Cramér 1946, Mathematical Methods of Statistics, 32.3).

A window ends where an error of its initial state has grown ``GROWTH``-fold: beyond, trajectories are chaotic, and the
bound, exponentially small, is out of reach. A load torque is not known (level, phase and frequency in each window), nor
is the noise of a measured torque: see ``unknown_torque``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain, Friction, Shaft
from ...errors import InvalidInput
from ...recording import Recording
from ...simulation import simulate
from ..equivalent import joint_of
from .drive import Drive
from .truth import equivalent
from .unknown_torque import Whitening, load_changes

Array = NDArray[np.float64]
Change = Callable[[Drivetrain, float], Drivetrain]

#: Length of a window, torsional periods; how many stand for the recording, evenly spread; growth that ends one, in the
#: energy norm, in which no error grows while the contacts stay (all option).
WINDOW, WINDOWS, GROWTH = 64.0, 12, 10.0
#: Step of the differences, relative (numerics: far above rounding, far below any gap).
STEP = 1e-5
#: A gap where the drive has none, over the wind-up: so small that more of it counts as if there were none (numerics).
TINY_GAP = 1e-3
#: Half width of a 95 % interval in standard deviations (numerics: of a normal error).
NORMAL = 1.96


def cramer_rao(drive: Drive) -> dict[str, float]:
    """95 % half width of each judged parameter, relative; of a backlash that the drive has not, in rad."""
    chain, windup = drive.truth.drivetrain, float(drive.dimensions["windup"])
    gap = any(s.has_backlash for s in chain.shafts)
    if chain.shafts and not gap:
        chain = _shafts(chain, lambda s: replace(s, backlash=TINY_GAP * windup), only=joint_of(chain))
    changed = [change(chain, STEP) for change in _changes(chain)]
    information, rows = np.zeros((len(changed),) * 2), 0
    for window in _windows(drive, chain):
        told, used = window.information(changed)
        information += told
        rows += used
    information *= len(drive.recording) / max(rows, 1)
    # What no window identifies gets a huge variance instead of an error.
    scale = np.sqrt(np.maximum(np.diag(information), 1e-6))
    inverse = np.linalg.inv(information / np.outer(scale, scale) + 1e-12 * np.eye(scale.size))
    covariance = inverse / np.outer(scale, scale)
    half = {}
    for name, row in _gradients(drive, chain, changed).items():
        half[name] = NORMAL * math.sqrt(max(float(row @ covariance @ row), 0.0))
    if chain.shafts and not gap:
        half["backlash"] *= TINY_GAP * windup
    return half


def _gradients(drive: Drive, chain: Drivetrain, changed: list[Drivetrain]) -> dict[str, Array]:
    """Relative change of each judged parameter with each change of the chain."""
    delay = drive.motion.delay * drive.motion.signals.dt
    base, *moved = (equivalent(one, drive.truth.signals, delay) for one in (chain, *changed))
    judged = drive.truth.parameters
    return {
        name: np.array([float(m[name] or 0.0) / value - 1.0 for m in moved]) / STEP
        for name, value in base.items()
        if value and judged[name] is not None
    }


@dataclass(frozen=True, eq=False)
class _Window:
    """A part of a recording that begins in a known state; ``exact`` is how it goes on.

    ``other_loads`` are its torques, each with another load torque.
    """

    drive: Drive
    chain: Drivetrain
    torques: Mapping[str, Array]
    state: Mapping[str, Any]
    exact: Recording
    other_loads: Sequence[Mapping[str, Array]]
    whitening: Whitening

    def information(self, changed: list[Drivetrain]) -> tuple[Array, int]:
        """Information (p, p) that the window has of the parameters, and its rows."""
        sensor = self.drive.sensor
        try:
            moved = [_run(self.chain, self.torques, state, self.exact.dt) for state in self._moved_states()]
            moved += [_run(self.chain, torques, self.state, self.exact.dt) for torques in self.other_loads]
            other = [_run(one, self.torques, self.state, self.exact.dt) for one in changed]
        except InvalidInput:  # a changed drive may chatter where the true one does not
            return np.zeros((len(changed),) * 2), 0
        end = self._end(moved[: len(self._units())])
        columns = [self._shown(run, end) for run in moved]
        if sensor.difference:  # the angle at the beginning is not known
            columns.append(np.ones(columns[0].size))
        told = np.array([self._shown(run, end) for run in other]) / STEP
        both = self.whitening.of_columns(np.vstack([np.array(columns), told]))
        nuisance, told = both[: len(columns)].T, both[len(columns) :]
        basis, weight = np.linalg.qr(nuisance / np.maximum(np.linalg.norm(nuisance, axis=0), 1e-300))
        basis = basis[:, np.abs(np.diag(weight)) > 1e-9]
        told = told - told @ basis @ basis.T
        return told @ told.T, told.shape[1]

    def _shown(self, run: Recording, end: int) -> Array:
        """Change of what is sensed, in each row of the recording, up to a step of the plant."""
        source = self.drive.sensor.source
        return (run[source] - self.exact[source])[: end : self.drive.motion.steps]

    def _moved_states(self) -> list[dict[str, Any]]:
        """Initial states that differ in one twist or speed each, all by the same small energy."""
        names = list(self.state["names"])
        states = []
        for i, unit in self._units().items():
            state = np.array(self.state["state"])
            state[names.index(i)] += STEP * unit
            states.append({**self.state, "state": tuple(state)})
        return states

    def _units(self) -> dict[str, float]:
        """What each twist (rad) and speed (rad/s) has to change by for half the energy that the torsion has."""
        chain, n = self.chain, len(self.chain.inertias)
        speeds = ["speed_motor", *(f"speed_{i + 1}" for i in range(1, n - 1)), "speed_load"][: max(n, 1)]
        if n == 1:
            return {"speed_motor": float(self.drive.dimensions["rated_speed"])}
        twists = ["twist"] if n == 2 else [f"twist_{i + 1}" for i in range(n - 1)]
        softest = min(s.stiffness for s in chain.shafts)
        energy = math.sqrt(softest) * float(self.drive.dimensions["windup"])
        stiff = {t: energy / math.sqrt(s.stiffness) for t, s in zip(twists, chain.shafts, strict=True)}
        heavy = {w: energy / math.sqrt(j) for w, j in zip(speeds, chain.inertias, strict=True)}
        return stiff | heavy

    def _end(self, moved: list[Recording]) -> int:
        """Step of the plant at which some error of the initial state has grown too far."""
        grown = np.zeros(len(self.exact))
        for run in moved:
            parts = [((run[n] - self.exact[n]) / (STEP * u)) ** 2 for n, u in self._units().items()]
            grown = np.maximum(grown, np.sum(parts, axis=0))
        far = np.flatnonzero(grown > GROWTH**2)
        return max(int(far[0]), 2 * self.drive.motion.steps) if far.size else len(self.exact)


def _windows(drive: Drive, chain: Drivetrain) -> Iterator[_Window]:
    motion = drive.motion
    torques = {
        name: motion.signals[name] for name in ("torque_motor", "torque_load") if name in motion.signals
    }
    steps, dt = motion.command.size * motion.steps, motion.signals.dt
    length = max(
        10 * motion.steps,
        round(WINDOW / (float(drive.dimensions["pole"]) * dt)) // motion.steps * motion.steps,
    )
    length = min(length, steps)
    count = max(1, min(WINDOWS, steps // length))
    starts = [
        round(i * (steps - length) / max(1, count - 1) / motion.steps) * motion.steps for i in range(count)
    ]
    state: Mapping[str, Any] | None = None
    changes, whitening, at = load_changes(drive), Whitening.of(drive), 0
    for start in starts:
        if start > at:
            part = {name: values[at:start] for name, values in torques.items()}
            state = _run(chain, part, state, dt).final_state
        part = {name: values[start : start + length] for name, values in torques.items()}
        before = state if state is not None else _at_rest(chain, part, dt)
        before = _from_zero_angle(before)
        exact = _run(chain, part, before, dt)
        loads = [
            {**part, "torque_load": part["torque_load"] + STEP * change[start : start + length]}
            for change in changes
        ]
        yield _Window(drive, chain, part, before, exact, loads, whitening)
        state, at = exact.final_state, start + length


def _run(
    chain: Drivetrain, torques: Mapping[str, Array], state: Mapping[str, Any] | None, dt: float
) -> Recording:
    return simulate(chain, dt=dt, state=state, **torques)  # type: ignore[arg-type]


def _at_rest(chain: Drivetrain, torques: Mapping[str, Array], dt: float) -> Mapping[str, Any]:
    """The state at rest as a run without torque leaves it."""
    return _run(chain, {name: np.zeros(2) for name in torques}, None, dt).final_state


def _from_zero_angle(state: Mapping[str, Any]) -> dict[str, Any]:
    """The same state with the motor angle at zero: differences of small angles are finer."""
    values = list(state["state"])
    values[list(state["names"]).index("angle_motor")] = 0.0
    return {**state, "state": tuple(values)}


def _changes(chain: Drivetrain) -> list[Change]:
    """Everything about a chain that is not known: each inertia, shaft and friction, changed by a relative step."""
    places = range(len(chain.inertias))
    changes: list[Change] = [
        lambda c, e, i=i: replace(  # type: ignore[misc]
            c, inertias=tuple((1.0 + e) * j if i == k else j for k, j in enumerate(c.inertias))
        )
        for i in places
    ]
    for i, shaft in enumerate(chain.shafts):
        for name in ("stiffness", "damping", *(["backlash"] if shaft.has_backlash else [])):
            changes.append(
                lambda c, e, i=i, name=name: _shafts(  # type: ignore[misc]
                    c, lambda s: replace(s, **{name: (1.0 + e) * getattr(s, name)}), only=i
                )
            )
    for i in places:
        changes += _friction_changes(chain.frictions[i], i)
    if chain.actuator.lag > 0.0:
        changes.append(lambda c, e: replace(c, actuator=replace(c.actuator, lag=(1.0 + e) * c.actuator.lag)))
    return changes


def _friction_changes(friction: Friction, place: int) -> list[Change]:
    def at_place(make: Callable[[Friction, float], Friction]) -> Change:
        return lambda c, e: replace(
            c, frictions=tuple(make(f, e) if i == place else f for i, f in enumerate(c.frictions))
        )

    def levels(f: Friction, plus: float, minus: float) -> Friction:
        return replace(f, coulomb=(plus * f.coulomb_plus, minus * f.coulomb_minus))

    if not friction.sticks:
        return []
    changes = [
        at_place(lambda f, e: levels(f, 1.0 + e, 1.0)),
        at_place(lambda f, e: levels(f, 1.0, 1.0 + e)),
        at_place(lambda f, e: replace(f, viscous=(1.0 + e) * f.viscous)),
    ]
    if friction.stribeck:
        changes.append(
            at_place(lambda f, e: replace(f, stribeck=tuple((w, (1.0 + e) * t) for w, t in f.stribeck)))
        )
    return changes


def _shafts(chain: Drivetrain, make: Callable[[Shaft], Shaft], only: int) -> Drivetrain:
    return replace(chain, shafts=tuple(make(s) if i == only else s for i, s in enumerate(chain.shafts)))
