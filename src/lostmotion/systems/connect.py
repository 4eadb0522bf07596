"""connect: several systems as one, joined by signal names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .discrete_system import DiscreteSystem, Matrix


@checks_arguments
def connect(
    systems: Sequence[DiscreteSystem],
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    name: str | None = None,
) -> DiscreteSystem:
    """Join systems: every input is connected to the output of the same name.

    Parameters
    ----------
    systems : sequence of DiscreteSystem
        All with one sample time.
    inputs : sequence of str
        External inputs of the joined law: all that no system has as an output.
    outputs : sequence of str
        Outputs of the joined law, out of the systems' outputs.
    name : str, optional
        Default: the systems' names, joined by ``_and_``.

    Returns
    -------
    DiscreteSystem
        States in the order of the systems; curves in an order in which each needs earlier ones only. A state
        name that several systems use is preceded by the system's name and a dot. An input has the check of the first
        system that checks it, for all. Not checked are outputs of the systems, and inputs whose prediction depends on
        themselves through another system.

    Raises
    ------
    InvalidInput
        If two systems have the same output, an input is neither an output nor listed, a listed name is unknown, sample
        times differ, or a signal depends on itself within one sample (algebraic loop).
    """
    source = _sources(systems, tuple(inputs), tuple(outputs))
    join = _Join(tuple(systems), tuple(inputs), source)
    curves = join.order()
    rows_z = [join.row(join.z_terms(c)) for c in curves]
    rows_y = [join.row(join.y_terms(*source[o])) for o in outputs]
    rows_x = [
        join.row(join.x_terms(s, i)) for s, system in enumerate(systems) for i in range(len(system.states))
    ]
    rows_p = [join.row(join.p_terms(s, i)) for s, i in join.checks]
    z, y, x, p = (join.split(rows, curves) for rows in (rows_z, rows_y, rows_x, rows_p))
    return DiscreteSystem(
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        states=_state_names(systems),
        dt=systems[0].dt,
        curves=tuple(systems[s].curves[i] for _, s, i in curves),
        F=z[0], G=z[1], H=z[2], C=y[0], D=y[1], J=y[2], A=x[0], B=x[1], E=x[2],
        checks=tuple(systems[s].checks[i] for s, i in join.checks), P=p[0], Q=p[1], R=p[2],
        initial_state=np.concatenate([s.initial_state for s in systems]),
        name="_and_".join(system.name for system in systems) if name is None else name,
    )  # fmt: skip


def _sources(
    systems: Sequence[DiscreteSystem], inputs: tuple[str, ...], outputs: tuple[str, ...]
) -> dict[str, tuple[int, int]]:
    """Signal name → (system, output number); finds every misuse of connect but the loop."""
    if not systems or not outputs:
        raise InvalidInput(
            "connect",
            f"{len(systems)} systems, {len(outputs)} outputs",
            "at least one system and one output",
            "Name the outputs of the law.",
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
                    f"an output of {makers}",
                    "an output of one system",
                    "Rename one with renamed().",
                )
            source[signal] = (s, i)
    _check_inputs(set(inputs), {signal for system in systems for signal in system.inputs}, set(source))
    unknown = sorted(set(outputs) - set(source))
    if unknown:
        raise InvalidInput(
            "connect.outputs", ", ".join(unknown), f"names out of {sorted(source)}", "Check the name."
        )
    return source


def _check_inputs(inputs: set[str], used: set[str], made: set[str]) -> None:
    """Of the joined law: exactly what its systems use and none of them makes."""
    for found, got, remedy in (
        (
            used - made - inputs,
            "no output of a system and not listed",
            "Add it to inputs, or check its name.",
        ),
        (inputs & made, "listed as inputs, but outputs of a system", "Drop it from inputs."),
        (inputs - used, "listed as inputs, but used by no system", "Drop it, or check its name."),
    ):
        if found:
            expected = "exactly the inputs that are no outputs of a system"
            raise InvalidInput("connect.inputs", f"{', '.join(sorted(found))}: {got}", expected, remedy)


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
    """Rows of the joined law: internal inputs are replaced until only states, external inputs and curves are left."""

    def __init__(
        self,
        systems: tuple[DiscreteSystem, ...],
        inputs: tuple[str, ...],
        source: Mapping[str, tuple[int, int]],
    ) -> None:
        self.systems = systems
        self.inputs = inputs
        self.source = source
        first: dict[str, tuple[int, int]] = {}
        for s, system in enumerate(systems):
            for i, check in enumerate(system.checks):
                if check.input in inputs:
                    first.setdefault(check.input, (s, i))
        #: Checks of the joined law: system, number in it.
        self.checks = [check for check in first.values() if self._is_predictable(*check, tuple(first))]
        self._rows: dict[_Node, dict[_Node, float]] = {}

    def _is_predictable(self, s: int, i: int, checked: tuple[str, ...]) -> bool:
        """Whether a check's prediction is available in time: it needs no input that is checked with it or later, and
        its curves no checked input at all."""
        later = checked[checked.index(self.systems[s].checks[i].input) :]
        open_ = [(node, False) for node in self.p_terms(s, i)]
        seen = set(open_)
        while open_:
            node, curved = open_.pop()
            if node[0] == "u" and node[1] < 0 and self.inputs[node[2]] in (checked if curved else later):
                return False
            new = {(needed, curved or node[0] == "w") for needed in self.needs(node)} - seen
            seen |= new
            open_ += new
        return True

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

    def p_terms(self, s: int, i: int) -> dict[_Node, float]:
        system = self.systems[s]
        return self._terms(s, i, (system.P, system.Q, system.R))

    def needs(self, node: _Node) -> dict[_Node, float]:
        """What a node depends on within the same sample: an input on its source, a curve on its argument."""
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
        """All curves, each after those that it needs, through all systems; a loop is an error.

        Those that the predictions of checked inputs need come first.
        """
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

        for s, i in self.checks:
            for needed in self.p_terms(s, i):
                visit(needed)
        for s, system in enumerate(self.systems):
            for kind, count in (("w", len(system.curves)), ("u", len(system.inputs))):
                for i in range(count):
                    visit((kind, s, i))
        return [node for node in done if node[0] == "w"]

    def row(self, terms: Mapping[_Node, float]) -> dict[_Node, float]:
        """The same sum with every internal input replaced by its source."""
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
