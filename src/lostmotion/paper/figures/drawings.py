"""Figures 1, 3, 6, 10, 11 and 14: setup and structure, drawn from the objects themselves."""

from __future__ import annotations

from ... import plot
from ..experiments import Experiments, observer, pi_law, placed_parts
from .style import PaperFigure


def rig(e: Experiments) -> PaperFigure:
    """Fig. 1: the test rig, here the virtual one."""
    return PaperFigure(
        number=1,
        title="Test rig",
        caption="The virtual rig: motor, clutch, side shaft, tripod joint with the gap, hub and brake disc.",
        image=plot.chain(e.rig.drivetrain, title="Virtual test rig"),
    )


def linear(e: Experiments) -> PaperFigure:
    """Fig. 3: the finite elements and the linear two masses in their place."""
    return PaperFigure(
        number=3,
        title="Linear two-mass oscillator",
        caption="From the finite elements above it, by the paper's four equations.",
        image=plot.reduction(e.structure, e.reduced, title="Finite elements and two masses"),
    )


def nonlinear(e: Experiments) -> PaperFigure:
    """Fig. 6: two masses with backlash and friction."""
    return PaperFigure(
        number=6,
        title="Nonlinear two-mass oscillator",
        caption="Backlash and friction as tested on the rig; the damper acts inside the gap too, as in equation (3).",
        image=plot.chain(e.model, title="Nonlinear two-mass oscillator"),
    )


def observer_structure(e: Experiments) -> PaperFigure:
    """Fig. 10: the observer."""
    return PaperFigure(
        number=10,
        title="Observer structure",
        caption="Observer 1 in discrete time: the curves are backlash and friction.",
        image=plot.block_diagram(observer(e.model), title="Observer 1"),
    )


def with_pi(e: Experiments) -> PaperFigure:
    """Fig. 11: the observer beside the PI controller."""
    return PaperFigure(
        number=11,
        title="Observer with PI controller",
        caption="The PI controller reads the motor speed alone.",
        image=plot.block_diagram(
            [pi_law(), observer(e.model)], plant=e.model, title="Observer 1 with PI controller"
        ),
    )


def with_pole_placement(e: Experiments) -> PaperFigure:
    """Fig. 14: Observer 1 with pole placement."""
    return PaperFigure(
        number=14,
        title="Observer 1 with pole placement controller",
        caption="K, V and DC are in the controller; it feeds back the elastic twist.",
        image=plot.block_diagram(
            placed_parts(e.model), plant=e.model, title="Observer 1 with pole placement"
        ),
    )
