"""The paper's figures that show results, in its layout, axes and units."""

from __future__ import annotations

from collections.abc import Callable

from ..experiments import Experiments
from . import frequency, identification, steps, structure
from .style import PaperFigure, styled

#: In the order of the paper.
FIGURES: tuple[Callable[[Experiments], PaperFigure], ...] = (
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

__all__ = ["FIGURES", "PaperFigure", "styled"]
