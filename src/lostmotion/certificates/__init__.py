"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .certificate import verdict
from .load_torque import prove_with_load
from .running import RunningProof, prove_running
from .statement import conditions, headline, stability

__all__ = [
    "RunningProof",
    "conditions",
    "headline",
    "prove_running",
    "prove_with_load",
    "stability",
    "verdict",
]
