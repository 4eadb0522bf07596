"""What the proof of a box says, in words: for the terminal, the report and a safety file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...argument_checks import checks_arguments
from ..statement import CONDITIONS, CONSTANT, acting
from .box_proof import BoxProof

#: What the parameters of a box are called.
WORDS: Mapping[str, str] = {
    "inertia_load": "load inertia", "inertia_motor": "motor inertia", "stiffness": "stiffness",
    "coulomb": "Coulomb friction", "backlash": "backlash",
}  # fmt: skip


@checks_arguments
def box_headline(proof: BoxProof) -> str:
    """One sentence that is read in ten seconds."""
    box = _box(proof.box)
    if not proof.proved:
        where = ", ".join(f"{WORDS[name]} × {share:.3g}" for name, share in (proof.stops_at or {}).items())
        done = (
            f" {proof.cells} cells, {100.0 * proof.share:.3g} % of the box, are proved."
            if proof.cells
            else ""
        )
        return f"Stability is not proved for {box}: {proof.reason}{f' ({where})' if where else ''}.{done}"
    directions = "in both directions" if proof.both_directions else "in the positive direction"
    end = "from every state"
    if proof.step is not None:
        end = f"after every step by up to {proof.step:g} rad/s between them"
    return (
        f"Proved for {box}: at every load speed from {proof.speed:g} to {proof.fastest:g} rad/s, {directions}, the "
        f"loop returns to its rest {end}, with the whole gap and friction."
    )


@checks_arguments
def box_stability(proof: BoxProof) -> dict[str, Any]:
    """The section "Stability" of the report for a box, as JSON can hold it."""
    values = f"{_box(proof.box)} around the certificate's values, all others exactly those"
    return {
        "headline": box_headline(proof),
        "proved": proof.proved,
        "speed_from": proof.speed,
        "speed_to": proof.fastest,
        "step": proof.step,
        "torque_load": list(proof.torque_load),
        "box": {name: list(ends) for name, ends in proof.box.items()},
        "cells": proof.cells,
        "share_of_the_box": proof.share,
        "stops_at": None if proof.stops_at is None else dict(proof.stops_at),
        "conditions": [
            *acting(proof.torque_load, proof.delay),
            CONSTANT,
            f"the drivetrain has {values}",
            *CONDITIONS,
        ],
        "not_proved": proof.reason,
        "checked": "in exact fractions by verify_certificate.py" if proof.proved else None,
    }


def _box(box: Mapping[str, tuple[float, float]]) -> str:
    """The box in words: parameters of one tolerance together."""
    alike: dict[str, list[str]] = {}
    for name, (low, high) in box.items():
        down, up = 100.0 * (1.0 - low), 100.0 * (high - 1.0)
        tolerance = f"±{up:.3g} %" if abs(up - down) < 1e-9 else f"−{down:.3g} % to +{up:.3g} %"
        alike.setdefault(tolerance, []).append(WORDS[name])
    return (
        "; ".join(f"{tolerance} of {', '.join(names)}" for tolerance, names in alike.items())
        or "no tolerance"
    )
