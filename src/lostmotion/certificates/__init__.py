"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .box import BoxProof, around, prove_box
from .box_simulation import simulated
from .box_statement import box_headline, box_stability
from .certificate import verdict
from .continuous_law import ContinuousLaw, continuous_observer_feedback, continuous_pi
from .load_torque import prove_with_load
from .observer_error import ObserverError, observer_error, observer_verdict
from .robustness.contact_margins import MARGIN_COLUMNS, margin_data, margin_table, margins
from .robustness.loop_margins import Margins
from .running import RunningProof, prove_running
from .statement import conditions, headline, stability

__all__ = [
    "MARGIN_COLUMNS",
    "BoxProof",
    "ContinuousLaw",
    "Margins",
    "ObserverError",
    "RunningProof",
    "around",
    "box_headline",
    "box_stability",
    "conditions",
    "continuous_observer_feedback",
    "continuous_pi",
    "headline",
    "margin_data",
    "margin_table",
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
