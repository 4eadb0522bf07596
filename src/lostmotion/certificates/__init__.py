"""Certificates: proofs that a drivetrain and its law are stable, checked in exact fractions."""

from .certificate import verdict
from .limit_cycles.harmonic_balance import Harmonic, HarmonicBalance, harmonic_balance
from .limit_cycles.parameter_map import LimitCycleMap, limit_cycle_map
from .limit_cycles.shooting import LimitCycle, limit_cycle
from .load_torque import prove_with_load
from .observer_error import ObserverError, observer_error, observer_verdict
from .robustness.contact_margins import MARGIN_COLUMNS, margin_data, margin_table, margins
from .robustness.loop_margins import Margins
from .running import RunningProof, prove_running
from .statement import conditions, headline, stability

__all__ = [
    "MARGIN_COLUMNS",
    "Harmonic",
    "HarmonicBalance",
    "LimitCycle",
    "LimitCycleMap",
    "Margins",
    "ObserverError",
    "RunningProof",
    "conditions",
    "harmonic_balance",
    "headline",
    "limit_cycle",
    "limit_cycle_map",
    "margin_data",
    "margin_table",
    "margins",
    "observer_error",
    "observer_verdict",
    "prove_running",
    "prove_with_load",
    "stability",
    "verdict",
]
