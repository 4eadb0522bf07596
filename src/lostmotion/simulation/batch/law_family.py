"""Variants that differ in their numbers only, run together in compiled code with laws in the loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..closed_loop import laws_in_loop
from ..inputs import check_lengths, last_set_point
from ..laws_in_loop import Law, LawsInLoop
from ..moved_end import started
from ..packing import numbers_of
from ..plant_run import PlantRun
from ..sensors import Sensor
from .family import new_summary

if TYPE_CHECKING:
    from ...kernels.batch.arrays import Summary
    from ...kernels.batch.laws import LawFamily

Array = NDArray[np.float64]

#: Contact states of a variant for which there is room (numerics: all of two shafts with friction at both ends); one
#: that enters more is run alone.
_ROOM = 128


@dataclass(frozen=True, eq=False)
class LawRun:
    """What a batch with laws runs; the arguments are those of ``simulate``, `given` its checked signals.

    Parameters
    ----------
    signals, quantiles : tuple of str
    step : int
        Samples from one that is kept for quantiles to the next.
    """

    dt: float
    law: Law | Sequence[Law]
    given: Mapping[str, Array]
    state: Sequence[float] | Mapping[str, Any] | None
    delay: int | Sequence[int]
    sensors: Mapping[str, Sensor]
    seed: int
    signals: tuple[str, ...]
    quantiles: tuple[str, ...]
    step: int

    @property
    def length(self) -> int:
        return check_lengths(self.given)

    def knows(self, drivetrain: Drivetrain) -> bool:
        """Whether the drivetrain's held end stays where it is, and no faults are wanted, which only recordings have."""
        moved = any(f"{kind}_{drivetrain.locked}" in self.given for kind in ("speed", "angle"))
        return not moved and not any(n.startswith("input_fault") for n in (*self.signals, *self.quantiles))

    def run(self, variants: Sequence[Drivetrain]) -> tuple[tuple[str, ...], tuple[str, ...], Summary]:
        """Names of the states, names of the signals that these variants have, and their summaries."""
        from ...kernels.batch.laws import run_variants_with_laws

        first = variants[0]
        loop, inputs = laws_in_loop(first, self.law, self.dt, self.given, self.delay, self.sensors, None)
        run = PlantRun(first, self.dt, inputs, started(first, self.state, None), self.length)
        while run.plant.room < min(run.plant.row_of_mode.size, _ROOM):
            run.plant.grow()
        places = self._places(run, loop)
        wanted = tuple(n for n in dict.fromkeys((*self.signals, *self.quantiles)) if n in places)
        tables, steps, kept = loop.tables(run, self.seed)
        numbers = np.array([numbers_of(variant, self.dt) for variant in variants])
        limits = [(v.actuator.torque_limit, v.actuator.rate_limit * self.dt) for v in variants]
        sampled = np.array([wanted.index(n) for n in self.quantiles if n in wanted], dtype=np.int64)
        summary = new_summary(len(variants), run, wanted, sampled, -(-self.length // self.step))
        family = self._family(
            run, tables, np.array([places[name] for name in wanted], dtype=np.int64), sampled
        )
        run_variants_with_laws(family, steps, numbers, np.array(limits), summary)
        del kept  # the laws' numbers, which the kernel reads by their address
        return run.plant.layout.names(), wanted, summary

    def _family(
        self, run: PlantRun, loop: Any, wanted: NDArray[np.int64], sampled: NDArray[np.int64]
    ) -> LawFamily:
        from ...kernels.batch.laws import LawFamily

        resumed = isinstance(self.state, Mapping)
        return LawFamily(
            entered=run.plant.entered(),
            two_mass=run.two_mass,
            loop=loop,
            first_state=loop.state.copy(),
            start=run.s[: run.plant.layout.states].copy(),
            digits=run.digits if resumed else np.zeros(0, dtype=np.int64),
            last=last_set_point(self.state),
            work=run.work,
            states=run.states,
            modes=run.modes,
            values=np.empty((len(run.plant.signal_names()), self.length)),
            wanted=wanted.reshape(-1, 2),
            sampled=sampled,
            step=self.step,
        )

    @staticmethod
    def _places(run: PlantRun, loop: LawsInLoop) -> dict[str, tuple[int, int]]:
        """Where each signal of a recording is found; the later ones stand for those of the same name."""
        from ...kernels.batch.laws import GIVEN, MEASURED, OUTPUT, OWN, TORQUE

        places: dict[str, tuple[int, int]] = {}
        for kind, names in (
            (OUTPUT, loop.outputs), (GIVEN, tuple(loop.given)), (TORQUE, run.plant.layout.inputs),
            (MEASURED, [f"{name}_measured" if name in loop.sensors else "" for name in loop.inputs]),
            (OWN, run.plant.signal_names()),
        ):  # fmt: skip
            places |= {name: (kind, i) for i, name in enumerate(names) if name}
        return places
