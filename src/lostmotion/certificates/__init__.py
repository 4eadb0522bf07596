"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .box import BoxProof, around, prove_box
from .certificate import verdict
from .continuous_law import ContinuousLaw, continuous_observer_feedback, continuous_pi
from .load_torque import prove_with_load
from .running import RunningProof, prove_running
from .statement import conditions, headline, stability

__all__ = [
    "BoxProof",
    "ContinuousLaw",
    "RunningProof",
    "around",
    "conditions",
    "continuous_observer_feedback",
    "continuous_pi",
    "headline",
    "prove_box",
    "prove_running",
    "prove_with_load",
    "stability",
    "verdict",
]
