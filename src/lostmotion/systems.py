"""DiscreteSystem: observers and controllers as data; connect joins them by signal names."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .curves import PiecewiseLinear
from .errors import InvalidInput
from .recording import Recording

if TYPE_CHECKING:
    from .kernels.law import LawTables

Matrix = NDArray[np.float64]

#: Rows and columns of each matrix, in the order of z = Fx + Gu + Hw, y = Cx + Du + Jw, x⁺ = Ax + Bu + Ew.
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
}

#: The law reports replaced inputs as bits of one number, which a 32-bit target must hold too.
MAX_INPUTS = 31

#: Relative difference up to which a recording's sample time counts as the law's (chosen).
DT_TOLERANCE = 1e-3


def _empty() -> NDArray[np.float64]:
    return np.empty(0)


@dataclass(frozen=True, eq=False, kw_only=True)
class DiscreteSystem:
    """A discrete law in Lur'e form: a linear system with static piecewise-linear curves.

    ::

        z  = F x + G u + H w        H strictly lower triangular: no algebraic loop
        wᵢ = curveᵢ(zᵢ)
        y  = C x + D u + J w
        x⁺ = A x + B u + E w

    Parameters
    ----------
    A, B, E, F, G, H, C, D, J : arrays
        Shapes follow from the equations; a matrix that is left out (or empty) is zero. Copied and read-only.
    curves : tuple of PiecewiseLinear
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
        triangular.
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
    initial_state: NDArray[np.float64] = field(default_factory=_empty)
    name: str = "law"

    def __post_init__(self) -> None:
        for kind in ("inputs", "outputs", "states", "curves"):
            object.__setattr__(self, kind, tuple(getattr(self, kind)))
        for kind in ("inputs", "outputs", "states"):
            _check_names(f"{self.name}.{kind}", getattr(self, kind))
        if len(self.inputs) > MAX_INPUTS:
            raise InvalidInput(
                f"{self.name}.inputs", f"{len(self.inputs)} inputs", f"at most {MAX_INPUTS}", "Split the law."
            )
        dt = float(self.dt)
        if not (math.isfinite(dt) and dt > 0.0):
            raise InvalidInput(
                f"{self.name}.dt", repr(self.dt), "a positive sample time in s", "Check the unit."
            )
        object.__setattr__(self, "dt", dt)
        for key, (rows, columns) in _SHAPES.items():
            shape = (len(getattr(self, rows)), len(getattr(self, columns)))
            object.__setattr__(self, key, _matrix(f"{self.name}.{key}", getattr(self, key), shape))
        start = _matrix(f"{self.name}.initial_state", self.initial_state, (len(self.states),))
        object.__setattr__(self, "initial_state", start)
        if np.any(np.triu(self.H)):
            raise InvalidInput(
                f"{self.name}.H", "nonzero entries on or above the diagonal", "strictly lower triangular",
                "Order the curves so that each uses earlier ones only; a loop needs a delay.",
            )  # fmt: skip

    def run(self, data: Recording | Mapping[str, ArrayLike], state: ArrayLike | None = None) -> Recording:
        """Run the law over recorded inputs.

        Parameters
        ----------
        data : Recording, or mapping of input name → (n,) array
            Must hold every input; a recording's sample time must be the law's within 0.1 %.
        state : (n_states,) array, optional
            State at the first row; default: ``initial_state``.

        Returns
        -------
        Recording
            The outputs (origin "estimated") and ``input_fault``, 1.0 where an input was not within ±1e30 and
            was replaced by the last good one; ``final_state["state"]`` is the state after the last row.
        """
        from .kernels.law import law_run

        time, inputs = self._inputs_of(data)
        start = self.initial_state if state is None else _matrix("state", state, (len(self.states),))
        full = np.concatenate([start, np.zeros(len(self.inputs))])
        outputs, faults = law_run(self.tables(), full, inputs)
        signals = {name: outputs[:, i] for i, name in enumerate(self.outputs)}
        signals["input_fault"] = (faults != 0).astype(float)
        return Recording(
            time=time,
            signals=signals,
            origin={**dict.fromkeys(self.outputs, "estimated"), "input_fault": "derived"},
            final_state={"state": full[: len(self.states)].copy()},
            meta={"law": self.name},
        )

    def _inputs_of(self, data: Recording | Mapping[str, ArrayLike]) -> tuple[Matrix, Matrix]:
        missing = [name for name in self.inputs if name not in data]
        if missing:
            raise InvalidInput(
                f"{self.name}.run",
                f"no {', '.join(missing)}",
                f"all of {', '.join(self.inputs)}",
                "Add the signal.",
            )
        columns = [np.asarray(data[name], dtype=np.float64) for name in self.inputs]
        if len({c.shape for c in columns}) > 1 or any(c.ndim != 1 for c in columns):
            shapes = ", ".join(f"{n}: {c.shape}" for n, c in zip(self.inputs, columns, strict=True))
            raise InvalidInput(
                f"{self.name}.run", shapes, "(n,) arrays of one length", "Crop or resample them."
            )
        if isinstance(data, Recording):
            if abs(data.dt / self.dt - 1.0) > DT_TOLERANCE:
                raise InvalidInput(
                    f"{self.name}.run", f"a recording with dt = {data.dt:g} s", f"the law's {self.dt:g} s",
                    "Design the law for the recording's sample time, or resample the recording.",
                )  # fmt: skip
            return data.time, np.array(columns, dtype=np.float64).reshape(-1, len(data)).T.copy()
        if not columns:
            raise InvalidInput(
                f"{self.name}.run", "a law without inputs", "a Recording", "Give its time axis."
            )
        time = self.dt * np.arange(columns[0].size, dtype=np.float64)
        return time, np.array(columns, dtype=np.float64).T.copy()

    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A: the poles with every curve at a constant value."""
        return np.asarray(np.linalg.eigvals(self.A), dtype=complex)

    def tables(self) -> LawTables:
        """The law in the form that the kernel runs."""
        from .kernels.law import LawTables

        rows = np.vstack(
            [
                np.hstack([self.F, self.G, self.H]),
                np.hstack([self.C, self.D, self.J]),
                np.hstack([self.A, self.B, self.E]),
            ]
        )
        row, column = np.nonzero(rows)
        points = [np.array(c.points) for c in self.curves]
        empty = np.empty((0, 2))
        z_w = np.vstack([empty, *points])
        return LawTables(
            n_states=len(self.states),
            n_inputs=len(self.inputs),
            n_curves=len(self.curves),
            n_outputs=len(self.outputs),
            row_start=np.searchsorted(row, np.arange(rows.shape[0] + 1)).astype(np.int64),
            column=column.astype(np.int64),
            value=rows[row, column],
            curve_start=np.cumsum([0, *(p.shape[0] for p in points)]).astype(np.int64),
            z_point=np.ascontiguousarray(z_w[:, 0]),
            w_point=np.ascontiguousarray(z_w[:, 1]),
            slope=np.array([s for c in self.curves for s in c.slopes], dtype=float),
        )

    def renamed(self, names: Mapping[str, str]) -> DiscreteSystem:
        """A copy with inputs and outputs renamed, old name → new name."""
        unknown = sorted(set(names) - set(self.inputs) - set(self.outputs))
        if unknown:
            raise InvalidInput(
                f"{self.name}.renamed",
                f"{unknown}",
                f"names out of {self.inputs + self.outputs}",
                "Check the name.",
            )
        return replace(
            self,
            inputs=tuple(names.get(n, n) for n in self.inputs),
            outputs=tuple(names.get(n, n) for n in self.outputs),
        )

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
            "curves": [
                {
                    "points": [list(p) for p in c.points],
                    "slope_left": c.slope_left,
                    "slope_right": c.slope_right,
                }
                for c in self.curves
            ],
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> DiscreteSystem:
        """The law that ``to_dict`` wrote."""
        expected = {"name", "dt", "inputs", "outputs", "states", "initial_state", "curves", *_SHAPES}
        if set(data) != expected:
            raise InvalidInput(
                "DiscreteSystem.from_dict",
                f"keys {sorted(data)}",
                f"{sorted(expected)}",
                "Write it with to_dict.",
            )
        curves = tuple(
            PiecewiseLinear(tuple((p[0], p[1]) for p in c["points"]), c["slope_left"], c["slope_right"])
            for c in data["curves"]
        )
        return cls(**{**data, "curves": curves})


def _check_names(where: str, names: tuple[str, ...]) -> None:
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice or not all(isinstance(n, str) and n for n in names):
        raise InvalidInput(
            where, f"{names!r}", "non-empty names without doubles", f"Rename {twice or 'them'}."
        )


def _matrix(where: str, values: ArrayLike, shape: tuple[int, ...]) -> Matrix:
    """A read-only copy of the given shape; an empty array gives zeros."""
    array = np.array(values, dtype=float)
    if array.size == 0:
        array = np.zeros(shape)
    if array.shape != shape:
        raise InvalidInput(
            where, f"shape {array.shape}", f"shape {shape}", "Count states, inputs, outputs, curves."
        )
    if not np.all(np.isfinite(array)):
        raise InvalidInput(where, "NaN or infinity", "finite numbers", "Check what it was computed from.")
    array.setflags(write=False)
    return array


def zero_order_hold(A: ArrayLike, B: ArrayLike, dt: float) -> tuple[Matrix, Matrix]:
    """Φ = exp(A·dt) and Γ = ∫exp(A·s)ds·B: the exact step of ẋ = Ax + Bu with u held over dt (s).

    A is (n, n), B is (n, m). Raises InvalidInput if dt is not a positive number.
    """
    from scipy.linalg import expm

    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidInput("dt", repr(dt), "a positive sample time in s", "Check the unit.")
    a, b = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    n, m = b.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = a, b
    step = expm(block * dt)
    return step[:n, :n], step[:n, n:]


def one_sample_delay(name: str, dt: float, delayed: str | None = None, start: float = 0.0) -> DiscreteSystem:
    """The signal ``name`` one sample later, as ``delayed`` (default: ``name`` + "_delayed"); breaks a loop.

    ``start`` is the first output value, in the signal's unit.
    """
    delayed = f"{name}_delayed" if delayed is None else delayed
    one = np.ones((1, 1))
    return DiscreteSystem(
        inputs=(name,), outputs=(delayed,), states=(delayed,), dt=dt, B=one, C=one,
        initial_state=np.array([start]), name=f"delay of {name}",
    )  # fmt: skip


def connect(
    systems: Sequence[DiscreteSystem],
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    name: str = "law",
) -> DiscreteSystem:
    """Join systems: every input takes the output of the same name, of whichever system makes it.

    Parameters
    ----------
    systems : sequence of DiscreteSystem
        All with one sample time.
    inputs : sequence of str
        External inputs of the joined law: all that no system makes.
    outputs : sequence of str
        Signals, out of the systems' outputs, that the joined law gives.
    name : str

    Returns
    -------
    DiscreteSystem
        States in the order of the systems; curves in an order in which each needs earlier ones only. A state
        name that several systems use is preceded by the system's name and a dot.

    Raises
    ------
    InvalidInput
        If a signal is made twice, an input is neither made nor listed, a listed name is unknown, sample times
        differ, or a signal depends on itself within one sample (algebraic loop).
    """
    source = _sources(systems, tuple(inputs), tuple(outputs))
    join = _Join(tuple(systems), tuple(inputs), source)
    curves = join.order()
    rows_z = [join.row(join.z_terms(c)) for c in curves]
    rows_y = [join.row(join.y_terms(*source[o])) for o in outputs]
    rows_x = [
        join.row(join.x_terms(s, i)) for s, system in enumerate(systems) for i in range(len(system.states))
    ]
    z, y, x = (join.split(rows, curves) for rows in (rows_z, rows_y, rows_x))
    return DiscreteSystem(
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        states=_state_names(systems),
        dt=systems[0].dt,
        curves=tuple(systems[s].curves[i] for _, s, i in curves),
        F=z[0], G=z[1], H=z[2], C=y[0], D=y[1], J=y[2], A=x[0], B=x[1], E=x[2],
        initial_state=np.concatenate([s.initial_state for s in systems]),
        name=name,
    )  # fmt: skip


def _sources(
    systems: Sequence[DiscreteSystem], inputs: tuple[str, ...], outputs: tuple[str, ...]
) -> dict[str, tuple[int, int]]:
    """Signal name → (system, output number); every misuse of connect but the loop is found here."""
    if not systems or not outputs:
        raise InvalidInput(
            "connect", "nothing", "at least one system and one output", "Name what the law gives."
        )
    times = sorted({s.dt for s in systems})
    if len(times) > 1:
        raise InvalidInput(
            "connect", f"sample times {times} s", "one sample time", "Design all for the same dt."
        )
    source: dict[str, tuple[int, int]] = {}
    for s, system in enumerate(systems):
        for i, signal in enumerate(system.outputs):
            if signal in source:
                makers = f"{systems[source[signal][0]].name!r} and {system.name!r}"
                raise InvalidInput(
                    f"connect: signal {signal!r}",
                    f"made by {makers}",
                    "one maker",
                    "Rename one with renamed().",
                )
            source[signal] = (s, i)
    used = {signal for system in systems for signal in system.inputs}
    unconnected = sorted(used - set(source) - set(inputs))
    checks = (
        (unconnected, "made by no system and not listed", "Add it to inputs, or check its name."),
        (sorted(set(inputs) & set(source)), "listed as inputs, but made by a system", "Drop it from inputs."),
        (
            sorted(set(inputs) - used),
            "listed as inputs, but used by no system",
            "Drop it, or check its name.",
        ),
    )
    for found, got, remedy in checks:
        if found:
            raise InvalidInput(
                "connect.inputs",
                f"{', '.join(found)}: {got}",
                "exactly the inputs that no system makes",
                remedy,
            )
    unknown = sorted(set(outputs) - set(source))
    if unknown:
        raise InvalidInput(
            "connect.outputs", ", ".join(unknown), f"names out of {sorted(source)}", "Check the name."
        )
    return source


def _state_names(systems: Sequence[DiscreteSystem]) -> tuple[str, ...]:
    plain = [state for system in systems for state in system.states]
    return tuple(
        f"{system.name}.{state}" if plain.count(state) > 1 else state
        for system in systems
        for state in system.states
    )


#: A quantity of one system: kind ("x" state, "u" input, "w" curve value), system number, index in it; an
#: external input is ("u", -1, index).
_Node = tuple[str, int, int]


class _Join:
    """Rows of the joined law: inputs are replaced until only states, external inputs and curves are left."""

    def __init__(
        self,
        systems: tuple[DiscreteSystem, ...],
        inputs: tuple[str, ...],
        source: Mapping[str, tuple[int, int]],
    ) -> None:
        self.systems = systems
        self.inputs = inputs
        self.source = source
        self._rows: dict[_Node, dict[_Node, float]] = {}

    def _terms(self, s: int, index: int, matrices: tuple[Matrix, Matrix, Matrix]) -> dict[_Node, float]:
        return {
            (kind, s, int(j)): float(matrix[index, j])
            for kind, matrix in zip("xuw", matrices, strict=True)
            for j in np.flatnonzero(matrix[index])
        }

    def x_terms(self, s: int, i: int) -> dict[_Node, float]:
        system = self.systems[s]
        return self._terms(s, i, (system.A, system.B, system.E))

    def y_terms(self, s: int, i: int) -> dict[_Node, float]:
        system = self.systems[s]
        return self._terms(s, i, (system.C, system.D, system.J))

    def z_terms(self, node: _Node) -> dict[_Node, float]:
        _, s, i = node
        system = self.systems[s]
        return self._terms(s, i, (system.F, system.G, system.H))

    def needs(self, node: _Node) -> dict[_Node, float]:
        """What a node is made of within the same sample: an input of its source, a curve of its argument."""
        kind, s, i = node
        if kind == "x" or s < 0:
            return {}
        if kind == "w":
            return self.z_terms(node)
        signal = self.systems[s].inputs[i]
        if signal in self.source:
            return self.y_terms(*self.source[signal])
        return {("u", -1, self.inputs.index(signal)): 1.0}

    def label(self, node: _Node) -> str:
        kind, s, i = node
        system = self.systems[s]
        return system.inputs[i] if kind == "u" else f"curve {i} of {system.name}"

    def order(self) -> list[_Node]:
        """All curves, each after those that it needs, through however many systems; a loop is an error."""
        done: dict[_Node, None] = {}
        path: list[_Node] = []

        def visit(node: _Node) -> None:
            if node in done:
                return
            if node in path:
                loop = [self.label(n) for n in path[path.index(node) :]]
                raise InvalidInput(
                    "connect", f"an algebraic loop through {' → '.join([*loop, loop[0]][::-1])}",
                    "no signal that depends on itself within one sample",
                    "Insert a delay, e.g. one_sample_delay(signal, dt).",
                )  # fmt: skip
            path.append(node)
            for needed in self.needs(node):
                visit(needed)
            path.pop()
            done[node] = None

        for s, system in enumerate(self.systems):
            for kind, count in (("w", len(system.curves)), ("u", len(system.inputs))):
                for i in range(count):
                    visit((kind, s, i))
        return [node for node in done if node[0] == "w"]

    def row(self, terms: Mapping[_Node, float]) -> dict[_Node, float]:
        """The same sum with every internal input replaced by what it is made of."""
        total: dict[_Node, float] = {}
        for node, coefficient in terms.items():
            internal = node[0] == "u" and node[1] >= 0
            part = self._input_row(node) if internal else {node: 1.0}
            for leaf, factor in part.items():
                total[leaf] = total.get(leaf, 0.0) + coefficient * factor
        return total

    def _input_row(self, node: _Node) -> dict[_Node, float]:
        if node not in self._rows:
            self._rows[node] = self.row(self.needs(node))
        return self._rows[node]

    def split(
        self, rows: Sequence[Mapping[_Node, float]], curves: Sequence[_Node]
    ) -> tuple[Matrix, Matrix, Matrix]:
        """Rows as matrices over states, external inputs and ordered curves."""
        states = [("x", s, i) for s, system in enumerate(self.systems) for i in range(len(system.states))]
        columns: Sequence[Sequence[_Node]] = (states, [("u", -1, i) for i in range(len(self.inputs))], curves)
        x, u, w = (
            np.array([[row.get(node, 0.0) for node in nodes] for row in rows]).reshape(len(rows), len(nodes))
            for nodes in columns
        )
        return x, u, w
