"""The leaderboard of the controllers: laws in the loop of the virtual rig, never of the design model."""

from .cases import CASES, Case
from .compare_controllers import compare_controllers
from .contestants import CONTESTANTS, Contestant
from .leaderboard import ControlTable

__all__ = ["CASES", "CONTESTANTS", "Case", "Contestant", "ControlTable", "compare_controllers"]
