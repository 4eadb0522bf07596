"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .box.box_proof import BoxProof, around, prove_box
from .box.box_simulation import simulated
from .box.box_statement import box_headline, box_stability
from .certificate import verdict
from .continuous.continuous_law import (
    ContinuousLaw,
    continuous_observer_feedback,
    continuous_pi,
    continuous_state_feedback,
)
from .limit_cycles.harmonic_balance import Harmonic, HarmonicBalance, harmonic_balance
from .limit_cycles.parameter_map import LimitCycleMap, limit_cycle_map
from .limit_cycles.shooting import LimitCycle, limit_cycle
from .load_torque import prove_with_load
from .observer.error_bound import ObserverError, observer_error, observer_verdict
from .robustness.contact_margins import margins
from .robustness.gap_share import largest_share
from .robustness.loop_margins import Margins
from .running import RunningProof, prove_running
from .statement import conditions, headline, stability

__all__ = [
    "BoxProof",
    "ContinuousLaw",
    "Harmonic",
    "HarmonicBalance",
    "LimitCycle",
    "LimitCycleMap",
    "Margins",
    "ObserverError",
    "RunningProof",
    "around",
    "box_headline",
    "box_stability",
    "conditions",
    "continuous_observer_feedback",
    "continuous_pi",
    "continuous_state_feedback",
    "harmonic_balance",
    "headline",
    "largest_share",
    "limit_cycle",
    "limit_cycle_map",
    "margins",
    "observer_error",
    "observer_verdict",
    "prove_box",
    "prove_running",
    "prove_with_load",
    "simulated",
    "stability",
    "verdict",
]
