"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .certificate import verdict
from .running import RunningProof, prove_running

__all__ = ["RunningProof", "prove_running", "verdict"]
