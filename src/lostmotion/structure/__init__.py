"""Structure: torsional finite elements from geometry or matrices, their eigenmodes, and reduction to a chain."""

from .elements import Coupling, Disc, Gear, ShaftSegment
from .from_frequencies import chain_from_frequencies, two_mass_from_frequencies
from .modes import Modes, modes, zeros
from .powertrain import GAP, paper_powertrain
from .reduction import ChainReduction, reduce_to_chain
from .torsional_model import TorsionalModel, assemble, from_drivetrain

__all__ = [
    "GAP",
    "ChainReduction",
    "Coupling",
    "Disc",
    "Gear",
    "Modes",
    "ShaftSegment",
    "TorsionalModel",
    "assemble",
    "chain_from_frequencies",
    "from_drivetrain",
    "modes",
    "paper_powertrain",
    "reduce_to_chain",
    "two_mass_from_frequencies",
    "zeros",
]
