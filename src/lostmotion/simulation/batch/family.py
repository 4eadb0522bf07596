"""Variants that differ in their numbers only, run together in compiled code under given torques."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..contact_states import relaxes
from ..inputs import check_lengths, last_set_point, plant_inputs, possible_inputs
from ..moved_end import started
from ..packing import numbers_of
from ..plant_run import PlantRun

if TYPE_CHECKING:
    from ...kernels.batch.arrays import Family, Summary

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TorqueRun:
    """What a batch without a law runs: checked torques, start, and what is wanted of every variant.

    Parameters
    ----------
    dt : float, s
    torques : mapping of name → (n,) array, Nm
    state : sequence or mapping, optional
        As for ``simulate``.
    signals, quantiles : tuple of str
    step : int
        Samples from one that is kept for quantiles to the next.
    """

    dt: float
    torques: Mapping[str, Array]
    state: Sequence[float] | Mapping[str, Any] | None
    signals: tuple[str, ...]
    quantiles: tuple[str, ...]
    step: int

    @property
    def length(self) -> int:
        return check_lengths(self.torques)

    def knows(self, drivetrain: Drivetrain) -> bool:
        """Whether the drivetrain has all the inputs that are given, and nothing else is wanted of it."""
        return not set(self.torques) - set(possible_inputs(drivetrain))

    def run(self, variants: Sequence[Drivetrain]) -> tuple[tuple[str, ...], tuple[str, ...], Summary]:
        """Names of the states, names of the signals that these variants have, and their summaries."""
        from ...kernels.batch.arrays import new_scratch
        from ...kernels.batch.run import run_variants
        from ...kernels.plant.contact_states import new_mode_work

        first = variants[0]
        inputs = plant_inputs(first, self.torques)
        run = PlantRun(first, self.dt, inputs, started(first, self.state, None), 0)
        names = (*run.plant.signal_names(), *inputs)
        wanted = tuple(n for n in dict.fromkeys((*self.signals, *self.quantiles)) if n in names)
        family = self._family(run, wanted)
        numbers = np.array([numbers_of(variant, self.dt) for variant in variants])
        limits = [(v.actuator.torque_limit, v.actuator.rate_limit * self.dt) for v in variants]
        summary = new_summary(len(variants), run, wanted, family.sampled, -(-self.length // self.step))
        work = new_mode_work(run.plant.chain)
        run_variants(family, numbers, np.array(limits), new_scratch(family), *work, summary)
        return run.plant.layout.names(), wanted, summary

    def _family(self, run: PlantRun, wanted: tuple[str, ...]) -> Family:
        """The kernel's view of what the variants share."""
        from ...kernels.batch.arrays import Family
        from ...kernels.plant.taylor_series import ORDER

        plant, layout = run.plant, run.plant.layout
        names, width = plant.signal_names(), plant.signal_weights.shape[1]
        units = np.eye(width)
        signal = np.zeros((len(wanted), width))
        for i, name in enumerate(wanted):
            at = layout.states + layout.inputs.index(name) if name in layout.inputs else None
            signal[i] = units[at] if at is not None else plant.signal_weights[names.index(name)]
        states = [_only_state(row, layout.states) for row in signal]
        given = [self.torques.get(name, np.zeros(self.length)) for name in layout.inputs]
        resumed = isinstance(self.state, Mapping)
        start = run.s[: layout.states].copy()
        return Family(
            chain=plant.chain,
            radix=plant.radix,
            modes=plant.row_of_mode.size,
            size=plant.size,
            order=ORDER,
            idle=layout.angle_motor,
            inputs=np.column_stack(given),
            start=start,
            digits=run.digits if resumed else np.zeros(0, dtype=np.int64),
            last=last_set_point(self.state),
            signal=signal,
            state=np.array(states, dtype=np.int64),
            sampled=np.array([wanted.index(n) for n in self.quantiles if n in wanted], dtype=np.int64),
            step=self.step,
            **plant.element_tables,
        )


def new_summary(
    count: int, run: PlantRun, wanted: Sequence[str], sampled: NDArray[np.int64], times: int
) -> Summary:
    """Room for the summaries of `count` variants."""
    from ...kernels.batch.arrays import Summary

    return Summary(
        status=np.zeros(count, dtype=np.int64),
        final=np.zeros((count, run.plant.layout.states)),
        peak=np.zeros((count, len(wanted))),
        square=np.zeros((count, len(wanted))),
        events=np.zeros((count, 4), dtype=np.int64),
        samples=np.zeros((count, sampled.size, times)),
    )


def _only_state(row: Array, states: int) -> int:
    """The state that a row is equal to; −1 if there is none."""
    used = np.flatnonzero(row)
    return int(used[0]) if used.size == 1 and used[0] < states and row[used[0]] == 1.0 else -1


def family_key(drivetrain: Drivetrain) -> tuple[Any, ...]:
    """Equal for drivetrains that differ in their numbers only, and have the same softest shaft."""
    shafts = drivetrain.shafts
    stiffness = [shaft.stiffness for shaft in shafts]
    return (
        len(drivetrain.inertias),
        drivetrain.locked,
        drivetrain.actuator.lag > 0.0,
        stiffness.index(min(stiffness)) if shafts else 0,
        *((shaft.has_backlash, shaft.contact, relaxes(shaft)) for shaft in shafts),
        *((friction.sticks, len(friction.stribeck)) for friction in drivetrain.frictions),
    )
