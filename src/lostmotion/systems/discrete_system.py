"""DiscreteSystem: an observer, a controller, or both together, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear
from ..errors import InvalidInput
from ..plain_data import entries, numbers, table, text, texts
from ..recording import Recording
from .checks import MAX_INPUTS, check_names, matrix_of, sample_time
from .input_check import InputCheck
from .inputs import input_columns, input_row, renamed_signals
from .law_tables import law_tables
from .recorded_run import recorded_run

if TYPE_CHECKING:
    from ..kernels.law.step import LawTables

Matrix = NDArray[np.float64]

#: Rows and columns of each matrix, in the order of z = Fx + Gu + Hw, y = Cx + Du + Jw, x⁺ = Ax + Bu + Ew,
#: p = Px + Qu + Rw.
_SHAPES = {
    "A": ("states", "states"),
    "B": ("states", "inputs"),
    "E": ("states", "curves"),
    "F": ("curves", "states"),
    "G": ("curves", "inputs"),
    "H": ("curves", "curves"),
    "C": ("outputs", "states"),
    "D": ("outputs", "inputs"),
    "J": ("outputs", "curves"),
    "P": ("checks", "states"),
    "Q": ("checks", "inputs"),
    "R": ("checks", "curves"),
}

_KEYS = ("name", "dt", "inputs", "outputs", "states", "initial_state", "curves", "checks", *_SHAPES)


def _empty() -> NDArray[np.float64]:
    return np.empty(0)


@checks_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class DiscreteSystem:
    """A discrete law in Lur'e form: a linear system with static piecewise-linear curves.

    ::

        z  = F x + G u + H w        H strictly lower triangular: no algebraic loop
        wᵢ = curveᵢ(zᵢ)
        y  = C x + D u + J w
        x⁺ = A x + B u + E w

    An input may have a check, with a prediction p = P x + Q u + R w of it, out of states, inputs without a check or
    with an earlier one, and curves that need no checked input: while it is missing, jumps or is frozen, p takes its
    place. See ``InputCheck``.

    Parameters
    ----------
    A, B, E, F, G, H, C, D, J, P, Q, R : arrays
        Shapes follow from the equations; a matrix that is left out (or empty) is zero. Copied and read-only.
    curves : tuple of PiecewiseLinear
    checks : tuple of InputCheck
        In the order of the rows of P, Q and R, which is that of their evaluation; at most one for each input.
    inputs, outputs, states : tuple of str
        Signal names, each without doubles.
    dt : float, s
        Sample time.
    initial_state : (n_states,) array
        Default: zeros.
    name : str

    Raises
    ------
    InvalidInput
        If a shape does not fit, a number is not finite, a name comes twice, H is not strictly lower
        triangular, a check is of no input, or its prediction needs an input that is checked with it or later.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[str, ...] = ()
    dt: float
    curves: tuple[PiecewiseLinear, ...] = ()
    A: Matrix = field(default_factory=_empty)
    B: Matrix = field(default_factory=_empty)
    E: Matrix = field(default_factory=_empty)
    F: Matrix = field(default_factory=_empty)
    G: Matrix = field(default_factory=_empty)
    H: Matrix = field(default_factory=_empty)
    C: Matrix = field(default_factory=_empty)
    D: Matrix = field(default_factory=_empty)
    J: Matrix = field(default_factory=_empty)
    checks: tuple[InputCheck, ...] = ()
    P: Matrix = field(default_factory=_empty)
    Q: Matrix = field(default_factory=_empty)
    R: Matrix = field(default_factory=_empty)
    initial_state: NDArray[np.float64] = field(default_factory=_empty)
    name: str = "law"

    def __post_init__(self) -> None:
        for kind in ("inputs", "outputs", "states", "curves", "checks"):
            object.__setattr__(self, kind, tuple(getattr(self, kind)))
        for kind in ("inputs", "outputs", "states"):
            check_names(f"{self.name}.{kind}", getattr(self, kind))
        if len(self.inputs) > MAX_INPUTS:
            raise InvalidInput(
                f"{self.name}.inputs", f"{len(self.inputs)} inputs", f"at most {MAX_INPUTS}", "Split the law."
            )
        object.__setattr__(self, "dt", sample_time(f"{self.name}.dt", self.dt))
        for key, (rows, columns) in _SHAPES.items():
            shape = (len(getattr(self, rows)), len(getattr(self, columns)))
            object.__setattr__(self, key, matrix_of(f"{self.name}.{key}", getattr(self, key), shape))
        start = matrix_of(f"{self.name}.initial_state", self.initial_state, (len(self.states),))
        object.__setattr__(self, "initial_state", start)
        if np.any(np.triu(self.H)):
            raise InvalidInput(
                f"{self.name}.H", "nonzero entries on or above the diagonal", "strictly lower triangular",
                "Order the curves so that each uses earlier ones only; a loop needs a delay.",
            )  # fmt: skip
        self._check_checks()

    def _check_checks(self) -> None:
        names = [check.input for check in self.checks]
        if len(set(names)) < len(names) or not set(names) <= set(self.inputs):
            raise InvalidInput(
                f"{self.name}.checks",
                f"{names}",
                f"inputs out of {self.inputs}, each once",
                "Check the names.",
            )
        checked = [self.inputs.index(name) for name in names]
        if np.any(np.triu(self.Q[:, checked])) or np.any(self.G[: self.early_curves, checked]):
            raise InvalidInput(
                f"{self.name}.checks", f"a prediction that needs an input out of {names} that is not checked yet",
                "predictions out of states, inputs without a check or with an earlier one, and curves that need none "
                "of the checked inputs",
                "Order the checks, and the curves so that those of the predictions come first.",
            )  # fmt: skip

    @property
    def early_curves(self) -> int:
        """How many curves are evaluated before the inputs are checked: up to the last that a prediction needs."""
        return int(np.max(np.nonzero(self.R)[1], initial=-1)) + 1

    def init(self, state: ArrayLike | None = None) -> NDArray[np.float64]:
        """Memory of the law at the first sample: states, last good inputs, memory of the checks.

        ``state`` (n_states,) is ``initial_state`` if left out; a longer one, as ``step`` and ``run`` leave it, is
        taken whole.
        """
        remembered = [number for check in self.checks for number in check.start()]
        full = np.concatenate([self.initial_state, np.zeros(len(self.inputs)), remembered])
        if state is not None:
            own = np.array(state, dtype=np.float64)
            size = full.size if own.shape == full.shape else len(self.states)
            full[:size] = matrix_of("state", own, (size,))
        return full

    def step(self, state: ArrayLike, inputs: ArrayLike) -> tuple[Matrix, Matrix, int]:
        """One sample: the new memory, the outputs, and a bit mask of the rejected inputs.

        ``state`` as ``init`` gives it is not changed; ``inputs`` (n_inputs,) in the order of ``inputs``.
        """
        from ..kernels.law.step import law_run

        new, values = self.init(state), input_row(self.name, self.inputs, inputs)
        outputs, faults = law_run(self.tables(), new, values[np.newaxis])
        return new, outputs[0], int(faults[0])

    def without_checks(self) -> DiscreteSystem:
        """The same law, which holds the last good value of a missing input and accepts all others."""
        return replace(self, checks=(), P=_empty(), Q=_empty(), R=_empty())

    @checks_arguments
    def run(self, data: Recording | Mapping[str, ArrayLike], state: ArrayLike | None = None) -> Recording:
        """Run the law over recorded inputs.

        Parameters
        ----------
        data : Recording, or mapping of input name → (n,) array
            Must contain every input; a recording's sample time must be the law's within 0.1 %.
        state : array, optional
            At the first row: (n_states,), or the memory from an earlier run or ``step``; default: ``init()``.

        Returns
        -------
        Recording
            The outputs (origin "estimated") and ``input_fault``, 1.0 where an input was not within ±1e30 and
            was replaced by the last good one, or where its check rejected it;
            ``final_state["state"]`` is the memory after the last row, the states first.
        """
        from ..kernels.law.step import law_run

        time, inputs = input_columns(self.name, self.inputs, self.dt, data)
        full = self.init(state)
        outputs, faults = law_run(self.tables(), full, inputs)
        return recorded_run(self.name, self.outputs, time, outputs, faults, full)

    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A: the poles with every curve at a constant value."""
        return np.asarray(np.linalg.eigvals(self.A), dtype=complex)

    def tables(self) -> LawTables:
        """The law in the form that the kernels run; the first one of a shape compiles its code (some ten ms)."""
        return self._tables

    @cached_property
    def _tables(self) -> LawTables:
        rows = np.vstack([
            np.hstack([self.F, self.G, self.H]),
            np.hstack([self.C, self.D, self.J]),
            np.hstack([self.A, self.B, self.E]),
            np.hstack([self.P, self.Q, self.R]),
        ])  # fmt: skip
        sizes = len(self.states), len(self.inputs), len(self.outputs)
        checks = [(self.inputs.index(check.input), check) for check in self.checks]
        return law_tables(rows, sizes, self.curves, self.early_curves, checks)

    def __getstate__(self) -> dict[str, Any]:
        """Without the tables: they contain an address of this process."""
        return {name: value for name, value in self.__dict__.items() if name != "_tables"}

    def renamed(self, names: Mapping[str, str]) -> DiscreteSystem:
        """A copy with inputs and outputs renamed, old name → new name."""
        inputs, outputs = renamed_signals(self.name, names, self.inputs, self.outputs)
        checks = tuple(replace(c, input=names.get(c.input, c.input)) for c in self.checks)
        return replace(self, inputs=inputs, outputs=outputs, checks=checks)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists, numbers and strings: ``from_dict`` gives back the very same law, also through JSON."""
        return {
            "name": self.name,
            "dt": self.dt,
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            "states": list(self.states),
            "initial_state": self.initial_state.tolist(),
            **{key: getattr(self, key).tolist() for key in _SHAPES},
            "curves": [curve.to_dict() for curve in self.curves],
            "checks": [check.to_dict() for check in self.checks],
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> DiscreteSystem:
        """The law that ``to_dict`` wrote.

        Raises
        ------
        InvalidInput
            If a key is missing or unknown, or a value is not what ``to_dict`` writes: nothing is filled in.
        """
        content = table("law", data, _KEYS)
        parts: dict[str, Any] = {
            **{kind: texts(kind, content[kind]) for kind in ("inputs", "outputs", "states")},
            "curves": tuple(
                PiecewiseLinear.from_dict(curve, f"curves[{i}]")
                for i, curve in enumerate(entries("curves", content["curves"]))
            ),
            "checks": tuple(
                InputCheck.from_dict(check, f"checks[{i}]")
                for i, check in enumerate(entries("checks", content["checks"]))
            ),
        }
        shapes = {key: (len(parts[rows]), len(parts[columns])) for key, (rows, columns) in _SHAPES.items()}
        parts |= {key: numbers(key, content[key], shape) for key, shape in shapes.items()}
        parts["initial_state"] = numbers("initial_state", content["initial_state"], (len(parts["states"]),))
        return cls(name=text("name", content["name"]), dt=content["dt"], **parts)
