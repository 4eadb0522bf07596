"""What is proved of the paper's loops, how long it takes, and whether the verifier says the same.

python benchmarks/certify.py [--mutations 1000] [--boxes] [--observers] [--largest SECONDS]
"""

from __future__ import annotations

import argparse
import os
import random
import sys
from pathlib import Path
from typing import Any

import lostmotion as lm
from lostmotion.certificates import (
    around,
    best_injection,
    continuous_observer_feedback,
    continuous_pi,
    largest_box,
    observer_error,
    observer_verdict,
    prove_box,
    prove_running,
    simulated,
    verdict,
)

TABLE_I: dict[str, Any] = {
    "inertia_motor": 0.0182, "inertia_load": 0.111, "stiffness": 6285.896, "damping": 0.397, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175,
}  # fmt: skip


def drivetrain(**changes: Any) -> lm.Drivetrain:
    return lm.Drivetrain.two_mass(**{**TABLE_I, **changes})


BOTH = ("torque_shaft", "speed_motor")


def feedback(
    plant: lm.Drivetrain,
    measured: tuple[str, ...] = ("speed_motor",),
    dt: float = 1e-4,
    observer: dict[str, Any] | None = None,
    **options: Any,
) -> lm.DiscreteSystem:
    parts = [
        lm.observers.kalman(plant, measured=measured, dt=dt, **(observer or {})),
        lm.controllers.pole_placement(plant, dt=dt, **options),
    ]
    return lm.connect(parts, ("speed_reference", *measured), ("torque_motor",))


def cases() -> dict[str, tuple[lm.Drivetrain, lm.DiscreteSystem, dict[str, Any]]]:
    """Loop → drivetrain, law, options of ``prove_running``."""
    plain, lagging, paper = drivetrain(), drivetrain(lag=3e-4), drivetrain(contact="dead_zone")
    less_torque = {"measurement_covariance": {"torque_shaft": 100.0}}
    injected = {**less_torque, "injection": {"speed_motor": 2e-4}}
    return {
        "PI, 0.1 ms": (plain, lm.controllers.pi(dt=1e-4), {}),
        "PI with torque limit, 0.1 ms": (plain, lm.controllers.pi(dt=1e-4, torque_limit=73.5), {}),
        "PI, 1 ms": (plain, lm.controllers.pi(dt=1e-3), {"substeps": 2}),
        "Observer 1, 0.1 ms": (plain, feedback(plain), {}),
        "Observer 1, dead_zone, 0.1 ms": (paper, feedback(paper), {}),
        "Observer 1, no compensation, 0.1 ms": (
            plain, feedback(plain, friction_compensation="none"), {},
        ),
        "Observer 1, compensation by reference, 0.1 ms": (
            plain, feedback(plain, friction_compensation="reference"), {},
        ),
        "Observer 1, lag 0.3 ms, delay 0.1 ms": (lagging, feedback(lagging), {"delay": 1}),
        "Observer 1, torque limit, 0.1 ms": (plain, feedback(plain, torque_limit=73.5), {}),
        "Observer 1, torque limit, lag, delay": (
            lagging, feedback(lagging, torque_limit=73.5), {"delay": 1},
        ),
        "Observer 1, 1 ms": (plain, feedback(plain, dt=1e-3), {"substeps": 2}),
        "Observer 1, 0.5 ms": (plain, feedback(plain, dt=5e-4), {}),
        "Observer 2, 0.1 ms": (plain, feedback(plain, BOTH), {}),
        "Observer 2, dead_zone, 0.1 ms": (paper, feedback(paper, BOTH), {}),
        "Observer 2, torque covariance 100, 0.1 ms": (
            plain, feedback(plain, BOTH, observer=less_torque), {},
        ),
        "the same with injection of 2e-4 s of the motor speed": (
            plain, feedback(plain, BOTH, observer=injected), {},
        ),
    }  # fmt: skip


def observers() -> None:
    """Bounds of the observers' errors, and the shares of the gap that the circle criterion proves."""
    plain, paper = drivetrain(), drivetrain(contact="dead_zone")
    print("| measured, injection | twist, mrad | speeds, rad/s | prove, s of CPU | verify |")
    print("|---|---|---|---|---|")
    for measured, injection, options in (
        (("speed_motor",), {}, {}),
        (("speed_motor",), {}, {"faces": 200}),
        (("speed_motor",), {"speed_motor": 1.43e-3}, {}),
        (BOTH, {}, {}),
    ):
        start = os.times().user
        found = observer_error(plain, measured, injection=injection, **options)
        proved = os.times().user
        agrees = found.certificate is not None and observer_verdict(found.certificate) is None
        bounds = dict(found.bounds or {})
        print(
            f"| {', '.join(measured)}, {injection} {options} | {1e3 * bounds['twist']:.1f} | "
            f"{bounds['speed_motor']:.2f}, {bounds['speed_load']:.2f} | {proved - start:.1f} | "
            f"{'proved' if agrees else 'REFUSED'}, {os.times().user - proved:.2f} s |"
        )
    known = paper.with_parameters(coulomb=0.0)
    for name, plant, measured, signal, largest in (
        ("motor speed", paper, ("speed_motor",), "speed_motor", 3e-3),
        ("motor speed, friction known", known, ("speed_motor",), "speed_motor", 3e-3),
        ("shaft torque and motor speed", paper, BOTH, "torque_shaft", 1.55e-4),
    ):
        best = best_injection(plant, measured, signal=signal, largest=largest)
        print(f"| {name} | {best.without:.4f} | {best.share:.5f} | {best.factor:.3g} |")


def table() -> None:
    print("| loop | proved from, rad/s | set-point there | steps up to | prove, s of CPU | verify |")
    print("|---|---|---|---|---|---|")
    for name, (plant, law, options) in cases().items():
        start = os.times().user
        proof = prove_running(plant, law, **options)
        proved = os.times().user
        if proof.certificate is None:
            print(f"| {name} | not proved: {proof.reason} | | | {proved - start:.1f} | |", flush=True)
            continue
        agrees = "proved" if verdict(proof.certificate) is None else "REFUSED"
        spent = os.times().user - proved
        steps = "any state" if proof.step is None else f"{proof.step:g}"
        print(
            f"| {name} | {proof.speed:g} | {proof.reference:.3g} | {steps} | {proved - start:.1f} | "
            f"{agrees}, {spent:.2f} s |",
            flush=True,
        )


def mutations(count: int) -> None:
    """Damaged certificates: the verifier's verdict against the independent check of the tests."""
    sys.path[:0] = [str(Path(__file__).parents[1] / "tests" / room) for room in ("certificates", "fixtures")]
    import test_verify_certificate as tests

    plain, plant = drivetrain(), drivetrain(torque_limit=73.5)
    pi = lm.controllers.pi(dt=1e-4, torque_limit=73.5)
    found = {
        "PI": prove_running(plant, pi, torque_load=(-1.0, 0.5), fastest=100.0),
        # Copies of the gap, and the region of a limit that acts.
        "Observer 1 with torque limit": prove_running(
            plain, feedback(plain, torque_limit=73.5), speeds=(0.5,)
        ),
    }
    for name, proof in found.items():
        assert proof.certificate is not None
        rng, paths = random.Random(1), tests.leaves(proof.certificate)
        agreed = proved = 0
        for _ in range(count // len(found)):
            data = tests.mutated(proof.certificate, rng, paths)
            own = tests.said(lambda d: verdict(d) is None, data)
            agreed += own == tests.said(tests.independent, data)
            proved += own
        print(
            f"{name}: {agreed} of {count // len(found)} verdicts agree; {proved} damaged certificates still prove "
            "their claim"
        )


def box_mutations(count: int) -> None:
    """The same for certificates of boxes."""
    sys.path[:0] = [
        str(Path(__file__).parents[1] / "tests" / room) for room in ("certificates/box", "fixtures")
    ]
    import test_box_mutations as tests

    for seed, name in enumerate(tests.BOXES):
        own = count // len(tests.BOXES) + (seed < count % len(tests.BOXES))
        agreed, proved = tests.verdicts(tests.certificate(name), own, seed)
        print(
            f"{name}: {agreed} of {own} verdicts agree; {proved} damaged certificates still prove their claim"
        )


FOUR = ("inertia_load", "stiffness", "coulomb", "backlash")
FIVE = (*FOUR, "inertia_motor")


def observer_mutations(count: int) -> None:
    """The same for the bound of an observer's error; every second damage is outside of the many multipliers."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "certificates" / "observer"))
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fixtures"))
    import test_error_bound as tests

    certificate = observer_error(drivetrain(), BOTH, faces=20).certificate
    assert certificate is not None
    rng, paths = random.Random(5), tests.leaves(certificate)
    few = [path for path in paths if "multipliers" not in path]
    agreed = proved = 0
    for i in range(count):
        data = tests.mutated(certificate, rng, few if i % 2 else paths)
        own = tests.said(lambda d: observer_verdict(d) is None, data)
        agreed += own == tests.said(tests.independent, data)
        proved += own
    print(f"{agreed} of {count} verdicts agree; {proved} damaged certificates still prove their claim")


def boxes() -> None:
    """Tolerances: cells, time of all processes, what the verifier says; where a proof stops, a simulation."""
    plant = drivetrain()
    laws: dict[str, Any] = {
        "continuous, Observer 1": continuous_observer_feedback(plant), "continuous, PI": continuous_pi(),
        "0.1 ms, Observer 1": feedback(plant), "0.1 ms, PI": lm.controllers.pi(dt=1e-4),
    }  # fmt: skip
    cases = [
        ("continuous, Observer 1", FOUR, (10, 20, 25, 30)), ("continuous, Observer 1", FIVE, (10, 20, 30)),
        ("continuous, PI", FOUR, (10, 20, 50)), ("continuous, PI", FIVE, (20,)),
        ("0.1 ms, PI", FOUR, (10, 20, 50)), ("0.1 ms, PI", FIVE, (20,)),
        ("0.1 ms, Observer 1", FOUR, (10, 15, 25)), ("0.1 ms, Observer 1", FIVE, (10, 25)),
    ]  # fmt: skip
    print("| loop | parameters | ± % | cells | prove, s of CPU | verify |")
    print("|---|---|---|---|---|---|")
    for name, parameters, percents in cases:
        for percent in percents:
            start = cpu_time()
            proof = prove_box(plant, laws[name], around(0.01 * percent, parameters))
            spent = cpu_time() - start
            head = f"| {name} | {len(parameters)} | {percent}"
            if proof.proved:
                start = cpu_time()
                said = "proved" if verdict(proof.certificate) is None else "REFUSED"
                print(
                    f"{head} | {proof.cells} | {spent:.1f} | {said}, {cpu_time() - start:.1f} s |", flush=True
                )
                continue
            why = proof.reason
            if isinstance(laws[name], lm.DiscreteSystem):
                why += f"; {simulated(plant, laws[name], proof)}"
            print(f"{head} | not proved at {proof.stops_at}: {why} | {spent:.1f} | |", flush=True)


def largest(seconds: float, workers: int) -> None:
    """The largest tolerance of the sampled loops that is proved in so many seconds."""
    plant = drivetrain()
    laws = {"0.1 ms, PI": lm.controllers.pi(dt=1e-4), "0.1 ms, Observer 1": feedback(plant)}
    print("| loop | parameters | ± % | cells | CPU time of the search, s | next wider |")
    print("|---|---|---|---|---|---|")
    for name, law in laws.items():
        for parameters in (FOUR, FIVE):
            start = cpu_time()
            found = largest_box(plant, law, parameters, seconds=seconds, workers=workers)
            cells = found.proof.cells if found.proof else 0
            wider = min((a for a in found.attempts if not a.proved), default=None)
            why = "" if wider is None else f"±{100 * wider.half_width:.0f} %: {wider.reason}"
            print(
                f"| {name} | {len(parameters)} | {100 * found.half_width:.0f} | {cells} | "
                f"{cpu_time() - start:.0f} | {why} |",
                flush=True,
            )


def cpu_time() -> float:
    """Of this process and those that it has waited for, s."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--mutations", type=int, default=0, help="only so many damaged certificates of this kind"
    )
    parser.add_argument("--boxes", action="store_true", help="tolerances instead of the nominal loops")
    parser.add_argument("--observers", action="store_true", help="errors of observers instead of the loops")
    parser.add_argument("--largest", type=float, default=0.0, help="seconds for each largest tolerance")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes of --largest")
    given = parser.parse_args()
    if given.largest:
        largest(given.largest, given.workers)
    elif given.mutations:
        damage = observer_mutations if given.observers else box_mutations if given.boxes else mutations
        damage(given.mutations)
    elif given.observers:
        observers()
    else:
        boxes() if given.boxes else table()
