"""The loop from sample to sample as a map of one vector: plant and law together, exact, with any sample time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...recording import Recording
from ...simulation import simulate
from ...systems import DiscreteSystem

Array = NDArray[np.float64]

#: State of the plant that turns on for ever, and that nothing depends on.
ANGLE = "angle_motor"


@dataclass(frozen=True, eq=False)
class LoopPoint:
    """Where the loop is at a sample: ``values`` (n,) of plant (without its angle) and law, and the plant's own state,
    with its contact states, as ``Recording.final_state`` has it."""

    values: Array
    plant: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A drivetrain under a law at a constant set-point.

    Parameters
    ----------
    drivetrain : Drivetrain
    law : DiscreteSystem
        With its delays, without input checks; speed_reference among its inputs.
    reference : float, rad/s
    torque_load : float, Nm
    """

    drivetrain: Drivetrain
    law: DiscreteSystem
    reference: float
    torque_load: float

    @cached_property
    def turning(self) -> list[int]:
        """Places of the plant's states but the angle."""
        names = self.run(2).final_state["names"]
        return [i for i, name in enumerate(names) if name != ANGLE]

    def start(self, state: Sequence[float]) -> LoopPoint:
        """Twist and speeds of a start, all else at zero, the law at its own start."""
        from ...simulation.plant_run import PlantRun

        run = PlantRun(self.drivetrain, self.law.dt, ("torque_motor",), tuple(state), 2)
        whole = run.s[: run.plant.layout.states]
        plant = {
            "names": run.plant.layout.names(), "state": tuple(whole.tolist()), "digits": tuple(run.digits.tolist()),
        }  # fmt: skip
        return LoopPoint(np.concatenate([whole[self.turning], self.law.initial_state]), plant)

    def run(self, samples: int, start: LoopPoint | None = None, dt: float | None = None) -> Recording:
        """So many samples, from a point or from rest in the middle of the gap; with the law's data held for ``dt``."""
        law, state = self.law, None
        if start is not None:
            plant = list(start.plant["state"])
            for place, value in zip(self.turning, start.values[: len(self.turning)], strict=True):
                plant[place] = float(value)
            state = {**start.plant, "state": tuple(plant)}
            law = replace(law, initial_state=start.values[len(self.turning) :])
        if dt is not None:
            law = replace(law, dt=dt)
        load = np.full(samples, self.torque_load) if self.torque_load else None
        reference = np.full(samples, self.reference)
        return simulate(
            self.drivetrain, law=law, dt=law.dt, state=state, torque_load=load, speed_reference=reference
        )

    def point(self, run: Recording) -> LoopPoint:
        """Where a run ended."""
        final = run.final_state
        plant = [final["state"][i] for i in self.turning]
        own = final["law"][0][: len(self.law.states)]
        return LoopPoint(np.concatenate([plant, own]), {k: final[k] for k in ("names", "state", "digits")})

    def after(self, samples: int, start: LoopPoint, values: Array, dt: float) -> Array:
        """The values (n,) after so many samples of length ``dt`` (s), from changed values of a point."""
        return self.point(self.run(samples, replace(start, values=values), dt)).values
