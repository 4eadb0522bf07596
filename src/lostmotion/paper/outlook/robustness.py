"""How robust is the law with respect to parameter changes?"""

from __future__ import annotations

from dataclasses import replace

from ...drivetrain import Drivetrain
from ...rig import Rig
from ..claims.control import response
from ..experiments import Experiments, pi_law, placed_law, speed_step
from ..figures import PaperFigure
from ..figures.style import MEASUREMENT, MODEL, column, legend
from .answer import Answer

#: Changes of the rig, the law stays as designed (option: what a drive sees between cold and warm, empty and loaded).
CHANGE = 0.2
#: What is changed, and how it is called.
CHANGED = ("load inertia", "motor inertia", "stiffness", "backlash", "friction")


def robustness(e: Experiments) -> Answer:
    """Overshoot of the paper's law and of PI with any one parameter of the rig changed."""
    laws = {"PI": pi_law(), "pole placement": placed_law(e.model)}
    changes = {"as designed": e.rig} | {
        f"{what} {sign}{100 * CHANGE:g} %": changed(e.rig, what, 1.0 + (CHANGE if sign == "+" else -CHANGE))
        for what in CHANGED
        for sign in ("−", "+")
    }
    found = {
        name: {what: response(speed_step(rig, law)).step.overshoot for what, rig in changes.items()}
        for name, law in laws.items()
    }
    placed = found["pole placement"]
    worst = max(placed, key=lambda what: placed[what])
    return Answer(
        question="The robustness with respect to parameter changes has also to be tested.",
        text=f"With any one parameter of the rig changed by {100 * CHANGE:g} % and the law left as it is, "
        f"pole placement overshoots by at most {placed[worst]:.1f} % ({worst}); PI by "
        f"{min(found['PI'].values()):.1f} to {max(found['PI'].values()):.1f} %. The load inertia decides. "
        "This is simulated on the rig, at these points; what is proved of a box of parameters stands above.",
        page="controller-leaderboard.md",
        numbers={
            "largest overshoot of pole placement, %": placed[worst],
            "overshoot of pole placement as designed, %": placed["as designed"],
            "largest overshoot of PI, %": max(found["PI"].values()),
        },
        figure=_figure(found),
    )


def changed(rig: Rig, what: str, factor: float) -> Rig:
    """The rig with one thing multiplied."""
    plant: Drivetrain = rig.drivetrain
    motor, *middle, load = plant.inertias
    match what:
        case "load inertia":
            plant = replace(plant, inertias=(motor, *middle, factor * load))
        case "motor inertia":
            plant = replace(plant, inertias=(factor * motor, *middle, load))
        case "stiffness":
            plant = replace(
                plant, shafts=tuple(replace(s, stiffness=factor * s.stiffness) for s in plant.shafts)
            )
        case "backlash":
            plant = replace(
                plant, shafts=tuple(replace(s, backlash=factor * s.backlash) for s in plant.shafts)
            )
        case _:
            disc = plant.frictions[-1]
            more = replace(
                disc, coulomb=factor * disc.coulomb_plus, viscous=factor * disc.viscous,
                stribeck=tuple((speed, factor * torque) for speed, torque in disc.stribeck),
            )  # fmt: skip
            plant = replace(plant, frictions=(*plant.frictions[:-1], more))
    return replace(rig, drivetrain=plant)


def _figure(found: dict[str, dict[str, float]]) -> PaperFigure:
    figure, (panel,) = column(1, 2.8)
    names = list(next(iter(found.values())))
    for (law, values), line, mark in zip(found.items(), (MEASUREMENT, MODEL), ("s", "o"), strict=True):
        panel.plot(
            [values[name] for name in names],
            range(len(names)),
            mark,
            color=line["color"],
            markersize=4.5,
            label=law,
        )
    panel.set_yticks(range(len(names)), names)
    panel.invert_yaxis()
    panel.set(xlabel="overshoot (% of the step)", xlim=(-0.3, None))
    legend(figure, [panel])
    return PaperFigure(
        number="robustness",
        title="Overshoot with one parameter of the rig changed",
        caption=f"Step −2 → 2 rad/s; each parameter of the rig ±{100 * CHANGE:g} %, the laws as designed.",
        image=figure,
    )
