"""The paper's figures: results in its layout, axes and units, setup and structure as drawings of the objects."""

from __future__ import annotations

from collections.abc import Callable

from ..experiments import Experiments
from . import drawings, frequency, identification, steps, structure
from .style import PaperFigure, styled

Draw = Callable[[Experiments], PaperFigure]

#: Results, one column wide: drawn and saved within ``styled``.
FIGURES: tuple[Draw, ...] = (
    structure.mode_shapes,
    structure.reduction,
    identification.torque_step,
    identification.characteristic_curves,
    frequency.response,
    frequency.coherence,
    steps.observer_1,
    steps.observer_2_noisy,
    steps.pulse,
)
#: Setup and structure, in the look of ``lostmotion.plot``.
DRAWINGS: tuple[Draw, ...] = (
    drawings.rig,
    drawings.linear,
    drawings.nonlinear,
    drawings.observer_structure,
    drawings.with_pi,
    drawings.with_pole_placement,
)

__all__ = ["DRAWINGS", "FIGURES", "PaperFigure", "styled"]
