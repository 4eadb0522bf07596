"""What a proof says, in words: for the terminal, the report and a safety file."""

from __future__ import annotations

from typing import Any

from ..argument_checks import checks_arguments
from .running import RunningProof

#: What voids every proof, whatever its numbers; the second stands for no box.
CONSTANT = "the set-point and the load torque are constant"
NO_TOLERANCE = "the drivetrain has exactly the values of the certificate: no tolerance of them is proved"
CONDITIONS = (
    "friction is Coulomb and viscous: no Stribeck curve, no breakaway level above it",
    "the law reads every signal as it is at its sample: no mean over the sample, no noise, no offset",
    "no input check of the law has fired, and every sample is taken in time",
)


@checks_arguments
def headline(proof: RunningProof) -> str:
    """One sentence that is read in ten seconds."""
    if proof.speed is None:
        return f"Stability is not proved: {proof.reason}."
    directions = "in both directions" if proof.both_directions else "in the positive direction"
    where = f"at every load speed from {proof.speed:g} to {proof.fastest:g} rad/s, {directions}{_load(proof)}"
    if proof.step is None:
        proved = f"Proved: {where}, the loop returns to its rest from every state, with the whole gap and friction."
    else:
        proved = (
            f"Proved: {where}, the loop comes to its rest after every step by up to {proof.step:g} rad/s between them, "
            "with the whole gap, friction and torque limit."
        )
    return proved + (" Not proved: the loop without load torque." if proof.torque_load[1] < 0.0 else "")


def _load(proof: RunningProof) -> str:
    """The load torque, where the proof needs one."""
    low, high = proof.torque_load
    return f" and with {-high:.3g} to {-low:.3g} Nm of load torque against the motion" if high < 0.0 else ""


@checks_arguments
def facts(proof: RunningProof) -> list[tuple[str, str]]:
    """The headline as a table, (question, answer): what a safety engineer reads first."""
    if proof.speed is None:
        return [("Proved", "nothing"), ("Reason", proof.reason)]
    low, high = proof.torque_load
    against = high < 0.0
    torque = "none but friction"
    if against:
        torque = f"{-high:.3g} to {-low:.3g} Nm against the motion, constant"
    elif low or high:
        torque = f"{low:.3g} to {high:.3g} Nm in the direction of motion, constant"
    sides = "both directions" if proof.both_directions else "positive direction"
    after = "every state"
    if proof.step is not None:
        after = f"every step of the load speed by up to {proof.step:g} rad/s, from rest"
    missing = [f"below {proof.speed:g} rad/s", "standstill"]
    if against or not (low or high):
        missing.insert(0, "without that load torque" if against else "with a load torque")
    return [
        ("Returns to its rest", f"at load speeds from {proof.speed:g} to {proof.fastest:g} rad/s, {sides}"),
        ("After", after),
        ("With a load torque of", torque),
        ("For a drivetrain within", "± 0 %: certify --box proves a tolerance"),
        ("Not proved", ", ".join(missing)),
    ]


@checks_arguments
def conditions(proof: RunningProof) -> list[str]:
    """What must hold for the headline, a sentence part each."""
    return [*acting(proof.torque_load, proof.delay), CONSTANT, NO_TOLERANCE, *CONDITIONS]


def acting(torque_load: tuple[float, float], delay: int) -> list[str]:
    """What acts on the loop, and when."""
    low, high = torque_load
    torque = "there is no load torque but friction"
    if low or high:
        torque = f"the load torque is constant between {low:.3g} and {high:.3g} Nm, positive in the direction of motion"
    samples = {0: "acts at its own sample", 1: "acts one sample later"}.get(
        delay, f"acts {delay} samples later"
    )
    return [torque, f"the torque {samples}"]


@checks_arguments
def stability(proof: RunningProof) -> dict[str, Any]:
    """The section "Stability" of the report, as JSON can hold it."""
    return {
        "headline": headline(proof),
        "facts": [list(fact) for fact in facts(proof)],
        "proved": proof.speed is not None,
        "speed_from": proof.speed,
        "speed_to": proof.fastest,
        "reference": proof.reference,
        "step": proof.step,
        "torque_load": list(proof.torque_load),
        "conditions": conditions(proof),
        "not_below": proof.reason,
        "checked": "in exact fractions by verify_certificate.py" if proof.speed is not None else None,
    }
