"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .box.box_proof import BoxProof, around, prove_box
from .box.box_simulation import simulated
from .box.box_statement import box_headline, box_stability
from .box.largest_box import LargestBox, largest_box
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
from .observer.error_bound import ObserverError, observer_error, observer_headline, observer_verdict
from .observer.observer_share import BestInjection, best_injection, observer_share
from .robustness.contact_margins import margins
from .robustness.gap_share import largest_share
from .robustness.loop_margins import Margins
from .robustness.peak_bounds import PeakBounds, peak_bounds
from .robustness.simulated_variants import VariantCount, count_variants
from .robustness.worst_case import WorstCase, worst_case
from .robustness.worst_reference import WorstReference, worst_reference
from .running import RunningProof, prove_running
from .statement import conditions, facts, headline, stability

__all__ = [
    "BestInjection",
    "BoxProof",
    "ContinuousLaw",
    "Harmonic",
    "HarmonicBalance",
    "LargestBox",
    "LimitCycle",
    "LimitCycleMap",
    "Margins",
    "ObserverError",
    "PeakBounds",
    "RunningProof",
    "VariantCount",
    "WorstCase",
    "WorstReference",
    "around",
    "best_injection",
    "box_headline",
    "box_stability",
    "conditions",
    "continuous_observer_feedback",
    "continuous_pi",
    "continuous_state_feedback",
    "count_variants",
    "facts",
    "harmonic_balance",
    "headline",
    "largest_box",
    "largest_share",
    "limit_cycle",
    "limit_cycle_map",
    "margins",
    "observer_error",
    "observer_headline",
    "observer_share",
    "observer_verdict",
    "peak_bounds",
    "prove_box",
    "prove_running",
    "prove_with_load",
    "simulated",
    "stability",
    "verdict",
    "worst_case",
    "worst_reference",
]
