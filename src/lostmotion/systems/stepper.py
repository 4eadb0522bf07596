"""Stepper: a law that does not fit the Lur'e form of DiscreteSystem, as data and a compiled step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput
from ..plain_data import flag, mapping, numbers, shown, table, text, texts, whole
from ..recording import Recording
from .checks import MAX_INPUTS, check_names, matrix_of, sample_time
from .inputs import input_columns, input_row, renamed_signals
from .recorded_run import recorded_run

Array = NDArray[np.float64]

#: Files of schema version 1 name a module under the key "kernel"; one of them has another name now.
_OLD_MODULES = "lostmotion.kernels.steppers_"
_RENAMED = {"radial_basis": "neural_network"}


@dataclass(frozen=True, eq=False, kw_only=True)
class Stepper:
    """A discrete law given by two pure functions; the state is passed, never stored.

    ::

        state          = init(parameters)
        state, outputs = step(parameters, state, inputs)

    Parameters
    ----------
    name : str
    inputs, outputs : tuple of str
        Signal names, each without doubles.
    dt : float, s
        Sample time.
    parameters : (n,) array
        All numbers that the functions need; copied and read-only.
    estimator : str
        Its kind: one of those in ``lostmotion.kernels.steppers``, or the name of a module of yours. It contains
        ``init`` and ``step``, compiled with the signatures ``INIT`` and ``STEP`` of
        ``lostmotion.kernels.estimators.runner``, and is loaded at the first use.
    state_names : mapping of name → int
        Positions of named values in the state.
    exportable : bool
        Whether ``export`` can write it as C code.

    Raises
    ------
    InvalidInput
        If a name comes twice, dt is not positive, a parameter is not finite.
    """

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dt: float
    parameters: Array
    estimator: str
    state_names: Mapping[str, int] = field(default_factory=dict)
    exportable: bool = False

    def __post_init__(self) -> None:
        for kind in ("inputs", "outputs"):
            object.__setattr__(self, kind, tuple(getattr(self, kind)))
            check_names(f"{self.name}.{kind}", getattr(self, kind))
        if not 1 <= len(self.inputs) <= MAX_INPUTS:
            raise InvalidInput(
                f"{self.name}.inputs", f"{len(self.inputs)} inputs", f"1 to {MAX_INPUTS}", "Split the law."
            )
        object.__setattr__(self, "dt", sample_time(f"{self.name}.dt", self.dt))
        parameters = matrix_of(f"{self.name}.parameters", self.parameters, (np.size(self.parameters),))
        object.__setattr__(self, "parameters", parameters)

    @property
    def functions(self) -> Any:
        """The module with ``init`` and ``step``; numba compiles or loads them here."""
        from ..kernels.steppers import MODULES

        return import_module(MODULES.get(self.estimator, self.estimator))

    def init(self) -> Array:
        """The state at the start: that of the law, then the last good inputs (zeros)."""
        own = self.functions.init(self.parameters.copy())
        return np.concatenate([own, np.zeros(len(self.inputs))])

    def step(self, state: ArrayLike, inputs: ArrayLike) -> tuple[Array, Array, int]:
        """One sample: the new state, the outputs, and a bit mask of the rejected inputs.

        ``state`` as ``init`` gives it is not changed; ``inputs`` (n_inputs,) in the order of ``inputs``.
        """
        from ..kernels.estimators.runner import checked_step

        new, values = self._state(state), input_row(self.name, self.inputs, inputs)
        outputs = np.empty(len(self.outputs))
        faults = checked_step(
            self.functions.step, self.parameters.copy(), new, values, np.empty_like(values), outputs
        )
        return new, outputs, int(faults)

    def run(self, data: Recording | Mapping[str, ArrayLike], state: ArrayLike | None = None) -> Recording:
        """Run the law over recorded inputs, as ``DiscreteSystem.run``.

        Parameters
        ----------
        data
            As there.
        state : array, optional
            State at the first row, from ``init`` or from the ``final_state["state"]`` of an earlier run.

        Returns
        -------
        Recording
            The outputs (origin "estimated") and ``input_fault``: 1.0 where an input was not within ±1e30 and was
            replaced by the last good one, or where the law rejected it and predicted through it;
            ``final_state["state"]`` is the state after the last row.
        """
        from ..kernels.estimators.runner import run_stepper

        time, inputs = input_columns(self.name, self.inputs, self.dt, data)
        full = self.init() if state is None else self._state(state)
        outputs, faults = run_stepper(
            self.functions.step, self.parameters.copy(), full, inputs, len(self.outputs)
        )
        return recorded_run(self.name, self.outputs, time, outputs, faults, full)

    def renamed(self, names: Mapping[str, str]) -> Stepper:
        """A copy with inputs and outputs renamed, old name → new name."""
        inputs, outputs = renamed_signals(self.name, names, self.inputs, self.outputs)
        return replace(self, inputs=inputs, outputs=outputs)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists, numbers and strings: ``from_dict`` gives back the very same law, also through JSON."""
        return {
            "name": self.name,
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            "dt": self.dt,
            "parameters": self.parameters.tolist(),
            "estimator": self.estimator,
            "state_names": dict(self.state_names),
            "exportable": self.exportable,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Stepper:
        """The law that ``to_dict`` wrote, of this package's own functions.

        Raises
        ------
        InvalidInput
            If a key is missing or unknown, a value is not what ``to_dict`` writes, the estimator is none of this
            package, or has another number of parameters or outputs.
        """
        from ..kernels.steppers import SIZES

        content = table("law", _of_this_version(data), {field.name for field in fields(cls)})
        estimator = text("estimator", content["estimator"])
        if estimator not in SIZES:
            raise InvalidInput(
                "estimator",
                shown(estimator),
                f"one of {', '.join(SIZES)}",
                "Make it with lostmotion.observers or lostmotion.controllers.",
            )
        count, outputs = SIZES[estimator]
        names = {kind: texts(kind, content[kind]) for kind in ("inputs", "outputs")}
        if len(names["outputs"]) != outputs:
            raise InvalidInput(
                "outputs",
                f"{len(names['outputs'])} names",
                f"the {outputs} of {estimator}",
                "Write it again.",
            )
        return cls(
            name=text("name", content["name"]),
            **names,
            dt=content["dt"],
            parameters=numbers("parameters", content["parameters"], (count,)),
            estimator=estimator,
            state_names={
                name: whole(f"state_names, {name}", place)
                for name, place in mapping("state_names", content["state_names"]).items()
            },
            exportable=flag("exportable", content["exportable"]),
        )

    def _state(self, state: ArrayLike) -> Array:
        copy = np.array(state, dtype=np.float64)
        expected = self.init().shape
        if copy.shape != expected or not np.all(np.isfinite(copy)):
            raise InvalidInput(
                f"{self.name}: state", f"shape {copy.shape}, or not finite", f"{expected[0]} finite numbers",
                "Take it from init() or from an earlier run.",
            )  # fmt: skip
        return copy


def _of_this_version(data: Mapping[str, Any]) -> dict[str, Any]:
    """What schema version 1 wrote, with the kind of estimator instead of a module's name."""
    own = mapping("law", data)
    if "estimator" not in own and str(own.get("kernel")).startswith(_OLD_MODULES):
        kind = own.pop("kernel").removeprefix(_OLD_MODULES)
        own["estimator"] = _RENAMED.get(kind, kind)
    return own
