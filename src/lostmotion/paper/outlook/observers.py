"""How do the observers that the paper names compare with the Kalman observer?"""

from __future__ import annotations

import numpy as np

from ... import signals
from ...compare.contestants import CONTESTANTS, Contestant, Sensing
from ...drivetrain import Drivetrain
from ...metrics import rmse, signal_range
from ...observers import speed_of_counts
from ...plot.frequency.bode import plain_ticks
from ...rig import record
from ...rig.nominal import MOTOR_ENCODER_BITS, TORQUE_NOISE
from .. import published
from ..experiments import Experiments, Identified, Run
from ..figures import PaperFigure
from ..figures.style import MEASUREMENT, MODEL, column, legend
from .answer import Answer

#: What the paper names, by the leaderboard's names; the extended Kalman filter stands for estimation of parameters.
NAMED = {
    "Observer 1": "Kalman, Observer 1", "sliding mode": "sliding mode [5, 6]", "super-twisting": "super-twisting [7]",
    "neural network": "neural network [8]", "H∞": "H∞, nonlinear observer [4]",
    "interacting models": "hybrid: interacting models [12]", "extended Kalman": "extended Kalman, adaptive",
}  # fmt: skip
#: The load inertia of the model in the second case, times what was identified (option).
WRONG = 1.2
#: Length and seed of the recording, s, and from when on it is judged (option: filters that adapt have settled).
SECONDS, SEED, FROM = 10.0, 7, 5.0


def other_observers(e: Experiments, identified: Identified) -> Answer:
    """Error of the load speed, as identified and with a wrong load inertia."""
    run, model = _recorded(e), identified.found.drivetrain
    wrong = model.with_parameters(inertia_load=WRONG * model.inertia_load)
    entries = [entry for entry in CONTESTANTS if entry.name in NAMED]
    found = {entry.name: (_error(entry, model, run), _error(entry, wrong, run)) for entry in entries}
    known, off = min(found, key=lambda name: found[name][0]), min(found, key=lambda name: found[name][1])
    first, errors = found["Observer 1"], [100.0 * pair[0] for pair in found.values()]
    return Answer(
        question="Sliding mode, super-twisting, neural network, H∞ and hybrid observers: other approaches.",
        text=f"With identified parameters all are level: {min(errors):.3f} to {max(errors):.3f} % of the "
        f"load speed's range, Observer 1 at {100 * first[0]:.3f} %, the best ({NAMED[known]}) at "
        f"{100 * found[known][0]:.3f} %. With a load inertia that is {100 * (WRONG - 1):.0f} % wrong "
        f"Observer 1 has {100 * first[1]:.2f} %. The filter that estimates the inertia stays at "
        f"{100 * found['extended Kalman'][1]:.2f} %; sliding mode ({100 * found['sliding mode'][1]:.2f} %) "
        f"and interacting models ({100 * found['interacting models'][1]:.2f} %) take it for an unknown "
        f"torque. Best is then: {NAMED[off]}.",
        page="leaderboard.md",
        numbers={f"error of {NAMED[name]}, % of range": 100.0 * values[0] for name, values in found.items()}
        | {
            f"error of {NAMED[name]} with a wrong load inertia, % of range": 100.0 * v[1]
            for name, v in found.items()
        },
        figure=_figure(found),
    )


def _recorded(e: Experiments) -> Run:
    """Motion through all of the gap, at several speeds."""
    torque = signals.excitation(
        SECONDS, published.DT, seed=SEED, inertia=published.INERTIA_TOTAL, coulomb=published.TABLE_I["coulomb"],
        viscous=published.TABLE_I["viscous"],
    )  # fmt: skip
    return Run(*record(e.rig, torque_motor=torque, dt=published.DT))


def _error(entry: Contestant, model: Drivetrain, run: Run) -> float:
    """RMS error of the load speed as a share of its range."""
    sensing = Sensing(published.DT, True, speed_of_counts(published.DT, 2**MOTOR_ENCODER_BITS), TORQUE_NOISE)
    law = entry.make(model, sensing)
    estimate = law.run(run.recording.only(*law.inputs))["speed_load_estimated"]
    judged = run.truth.signals.time >= FROM
    true = run.truth.signals["speed_load"][judged]
    return rmse(np.asarray(estimate)[judged], true) / signal_range(true)


def _figure(found: dict[str, tuple[float, float]]) -> PaperFigure:
    figure, (panel,) = column(1, 2.6)
    places = range(len(found))
    cases = (("identified", MODEL, "o"), (f"load inertia {100 * (WRONG - 1):.0f} % wrong", MEASUREMENT, "s"))
    for case, (label, line, mark) in enumerate(cases):
        values = [100.0 * pair[case] for pair in found.values()]
        panel.plot(values, places, mark, color=line["color"], markersize=4.5, label=label)
    panel.set_yticks(places, [NAMED[name] for name in found])
    panel.invert_yaxis()
    panel.set(xscale="log", xlabel="error (% of range)")
    plain_ticks(panel)
    legend(figure, [panel])
    return PaperFigure(
        number="observers",
        title="Error of the load speed: the observers that the paper names",
        caption="Motor torque and motor speed alone, 10 s on the virtual rig, judged from 5 s on.",
        image=figure,
    )
