"""V of a certificate never rises along the exact simulation, from far starts, through impacts and sticking."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import prove_running
from lostmotion.certificates.equilibrium import Equilibrium, equilibrium
from lostmotion.certificates.lure import LureLoop, lure_loop, with_memory
from lostmotion.certificates.static_curves import StaticCurve
from lostmotion.systems import pruned

DT = 1e-4


def integral(curve: StaticCurve, start: float, ends: np.ndarray) -> np.ndarray:
    """∫ (w(z) − w(start)) dz from start to each end, segment by segment."""
    segment = curve.segment(Fraction(start))
    assert segment is not None
    at_start = sum(float(c) * z for c, z in zip(curve.line(segment), (1.0, start), strict=True))
    edges = [-np.inf, *(float(z) for z, _ in curve.points), np.inf]
    total = np.zeros_like(ends)
    for i, slope in enumerate(curve.slopes):
        if slope is None:
            continue
        value, steep = (float(c) for c in curve.line(i))
        low, high = np.clip(start, edges[i], edges[i + 1]), np.clip(ends, edges[i], edges[i + 1])
        total += (high - low) * (value - at_start + 0.5 * steep * (low + high))
    return total


def of_the_state(loop: LureLoop) -> list[int]:
    """Law curves whose argument hangs on the law's state alone."""
    found: list[int] = []
    for j in range(len(loop.law_curves)):
        inside = set(map(int, np.flatnonzero(loop.N_v[j])))
        if not np.any(loop.N[j, :4]) and not np.any(loop.N_w[j]) and inside <= set(found):
            found.append(j)
    return found


def v_of(loop: LureLoop, rest: Equilibrium, proof: dict[str, Any], states: np.ndarray) -> np.ndarray:
    """V just after a sample, for each row of states."""
    m, p = proof["multipliers"], len(loop.plant_curves)
    xi = states - rest.state.astype(float)
    arguments = [loop.Z[i].astype(float) @ states.T for i in range(p)]
    values: dict[int, np.ndarray] = {}
    total = np.zeros(len(states))
    for i, z in enumerate(arguments):
        weight = m["eta_plus"][i] - m["eta_minus"][i]
        total += 2.0 * weight * integral(loop.plant_curves[i], float(rest.arguments[i]), z)
    for j, plus, minus in zip(of_the_state(loop), m["theta_plus"], m["theta_minus"], strict=True):
        curve = loop.law_curves[j]
        s = loop.N[j].astype(float) @ states.T
        s += sum(float(loop.N_v[j, i]) * v for i, v in values.items())
        points = [(float(z), float(w)) for z, w in curve.points]
        values[j] = np.interp(s, *zip(*points, strict=True))
        total += 2.0 * (plus - minus) * integral(curve, float(rest.arguments[p + j]), s)
    at_rest = [float(curve.line(rest.segments[p + j])[0]) for j, curve in enumerate(loop.law_curves)]
    zeta = np.column_stack([xi, *(v - at_rest[j] for j, v in values.items())])
    return total + np.einsum("ki,ij,kj->k", zeta, np.array(proof["P"][0]), zeta)


def laws(plant: lm.Drivetrain) -> dict[str, lm.DiscreteSystem]:
    def feedback(*measured: str, **options: Any) -> lm.DiscreteSystem:
        observer = lm.observers.kalman(plant, measured=measured, dt=DT, **options)
        parts = [observer, lm.controllers.pole_placement(plant, dt=DT)]
        return lm.connect(parts, ("speed_reference", *measured), ("torque_motor",))

    return {
        "pi": lm.controllers.pi(dt=DT),
        "observer 1": feedback("speed_motor"),
        "observer 2": feedback("torque_shaft", "speed_motor"),
        "injection": feedback(
            "torque_shaft", "speed_motor", measurement_covariance={"torque_shaft": 100.0},
            injection={"speed_motor": 2e-4},
        ),
    }  # fmt: skip


#: Curves whose arguments the proof remembers: the plant's, then the law's.
REMEMBERED = {"pi": [], "observer 1": [], "observer 2": [0], "injection": [0, 2, 4]}


def remembered(loop: LureLoop, states: np.ndarray, own: np.ndarray, reference: float) -> np.ndarray:
    """What the loop remembers of each sample, by the plant's states and the law's before it."""
    n, p = states.shape[1], len(loop.plant_curves)
    before = np.zeros((len(states), len(loop.states)))
    before[:, :4], before[:, 4:n] = states[:, :4], own

    def value(curve: StaticCurve, z: np.ndarray) -> np.ndarray:
        return np.interp(z, *zip(*((float(x), float(w)) for x, w in curve.points), strict=True))

    # Friction of the plant, a jump, is read by no law.
    w = np.column_stack([value(c, before @ loop.Z[i].astype(float)) for i, c in enumerate(loop.plant_curves)])
    w[:, [i for i in range(p) if loop.names[i] != "gap"]] = 0.0
    v = np.zeros((len(states), len(loop.law_curves)))
    for j, curve in enumerate(loop.law_curves):
        s = before @ loop.N[j].astype(float) + w @ loop.N_w[j].astype(float) + v @ loop.N_v[j].astype(float)
        v[:, j] = value(curve, s + float(loop.M[j, 0]) * reference)
    after = before @ loop.S.T.astype(float) + w @ loop.S_w.T.astype(float) + v @ loop.S_v.T.astype(float)
    return (after + loop.R[:, 0].astype(float) * reference)[:, n:]


@pytest.mark.parametrize("name", list(REMEMBERED))
def test_v_never_rises(name: str) -> None:
    law = pruned(laws(PAPER)[name].without_checks())
    found = prove_running(PAPER, law, speeds=(1.0, 2.5, 80.0))
    assert found.certificate is not None
    memory = found.certificate["proof"].get("memory", [])
    assert memory == REMEMBERED[name]
    loop = with_memory(lure_loop(PAPER, law), memory)
    n = len(law.states)
    shown = replace(
        law, outputs=("torque_motor", *(f"state_{i}" for i in range(n))), C=np.vstack([law.C, np.eye(n)]),
        D=np.vstack([law.D, np.zeros((n, len(law.inputs)))]), J=np.vstack([law.J, np.zeros((n, len(law.curves)))]),
    )  # fmt: skip
    rng = np.random.default_rng(7)
    touched = 0
    for _ in range(12):
        speed = float(rng.uniform(found.speed or 0.0, 4.0))
        rest = equilibrium(loop, Fraction(speed))
        assert rest is not None
        start = (rng.uniform(-0.02, 0.02), rng.uniform(-8.0, 8.0), rng.uniform(-4.0, 4.0))
        run = lm.simulate(
            PAPER, law=shown, dt=DT, state=start, speed_reference=np.full(3000, float(rest.reference))
        )
        own = np.column_stack([run[f"state_{i}"] for i in range(n)])
        plant_states = np.column_stack(
            [run[name] for name in ("twist", "speed_motor", "speed_load", "torque_motor")]
        )
        states = np.hstack([plant_states[:-1], own[1:]])
        states = np.hstack([states, remembered(loop, states, own[:-1], float(rest.reference))])
        v = v_of(loop, rest, found.certificate["proof"], states)
        assert np.all(v > 0.0)
        # Rounding of the simulation, relative to where it starts.
        assert np.max(np.diff(v)) <= 1e-11 * v[0]
        assert v[-1] < 0.2 * v[0]
        touched += len(run.events)
    assert touched > 20, "impacts, separations, sticking: the proof is about them"
