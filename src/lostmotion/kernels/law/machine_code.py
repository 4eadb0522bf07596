"""Machine code for the step of a discrete law, made from which of its coefficients are not zero.

The code holds no numbers: they are read from memory, so that all laws of one shape share it, as a fit's thousands do.
It is straight through (what a loop over a table spends on indices is more than the sums themselves), takes some ten
milliseconds to make, and lives as long as the process. Every sum runs from left to right over products that are
rounded by themselves, as in the exported C.
"""

from __future__ import annotations

import struct
import threading
from typing import Any, NamedTuple

from ..estimators.verdicts import INPUT_BOUND, START_AGAIN, USE
from .input_check import LARGER, LEARNED, REMEMBERED, SUDDEN, check

#: Slope of a curve's segment: nought, one, or any other. A flat one need not wait for the curve's argument.
FLAT, ONE, STEEP = 0, 1, 2


class LawShape(NamedTuple):
    """What the code depends on; rows, curves and checks as in ``law.LawTables``."""

    n_states: int
    n_inputs: int
    n_curves: int
    n_outputs: int
    n_early: int  # curves that are evaluated before the inputs are checked
    rows: tuple[tuple[int, ...], ...]  # columns of the coefficients that are not zero
    slopes: tuple[tuple[int, ...], ...]  # of each curve's segments: FLAT, ONE or STEEP
    #: Input, whether it keeps its last good value, stands alone, and is replaced only where it is missing.
    checks: tuple[tuple[int, bool, bool, bool], ...]


def _number(value: float) -> str:
    """A constant in LLVM's language, to the last bit."""
    return f"0x{struct.pack('>d', value).hex().upper()}"


class _Writer:
    """Lines of LLVM's language; numbers come from one array, in the order in which they are asked for by place."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.block = "entry"
        self._count = 0

    def new(self) -> str:
        self._count += 1
        return f"%v{self._count}"

    def make(self, text: str) -> str:
        """A new value."""
        name = self.new()
        self.lines.append(f"{name} = {text}")
        return name

    def load(self, array: str, place: int) -> str:
        return self.make(f"load double, ptr {self.at(array, place)}")

    def at(self, array: str, place: int) -> str:
        return self.make(f"getelementptr double, ptr {array}, i64 {place}")

    def store(self, value: str, array: str, place: int) -> None:
        self.lines.append(f"store double {value}, ptr {self.at(array, place)}")

    def label(self, name: str) -> None:
        self.lines.append(f"{name}:")
        self.block = name

    def usable(self, value: str) -> str:
        low = self.make(f"fcmp oge double {value}, {_number(-INPUT_BOUND)}")
        high = self.make(f"fcmp ole double {value}, {_number(INPUT_BOUND)}")
        return self.make(f"and i1 {low}, {high}")

    def times(self, value: str, factor: float) -> str:
        return self.make(f"fmul double {value}, {_number(factor)}")

    def size(self, value: str) -> str:
        return self.make(f"call double @llvm.fabs.f64(double {value})")

    def larger(self, a: str, b: str) -> str:
        return self.make(f"select i1 {self.make(f'fcmp ogt double {a}, {b}')}, double {a}, double {b}")

    def smaller(self, a: str, b: str) -> str:
        return self.make(f"select i1 {self.make(f'fcmp olt double {a}, {b}')}, double {a}, double {b}")


def _row(w: _Writer, columns: tuple[int, ...], place: int, v: list[str]) -> str:
    total = ""
    for i, column in enumerate(columns):
        product = w.make(f"fmul double {w.load('%numbers', place + i)}, {v[column]}")
        total = w.make(f"fadd double {total}, {product}") if total else product
    return total or "0.0"


def _segment(w: _Writer, slope: int, z: str, z_at: int, w_at: int, slope_at: int) -> str:
    value = w.load("%numbers", w_at)
    if slope == FLAT:
        return value
    rise = w.make(f"fsub double {z}, {w.load('%numbers', z_at)}")
    if slope == STEEP:
        rise = w.make(f"fmul double {w.load('%numbers', slope_at)}, {rise}")
    return w.make(f"fadd double {value}, {rise}")


def _curve(w: _Writer, i: int, slopes: tuple[int, ...], z_at: int, w_at: int, slope_at: int, z: str) -> str:
    """Curve i at z, measured from the next point on the left (from the first point if there is none)."""
    values, last = [], len(slopes) - 1
    for segment, slope in enumerate(slopes):
        if segment < last:
            past = w.make(f"fcmp oge double {z}, {w.load('%numbers', z_at + segment)}")
            w.lines.append(f"br i1 {past}, label %c{i}n{segment}, label %c{i}s{segment}")
            w.label(f"c{i}s{segment}")
        anchor = max(segment - 1, 0)
        value = _segment(w, slope, z, z_at + anchor, w_at + anchor, slope_at + segment)
        values.append((value, w.block))
        w.lines.append(f"br label %c{i}end")
        if segment < last:
            w.label(f"c{i}n{segment}")
    w.label(f"c{i}end")
    return w.make("phi double " + ", ".join(f"[{value}, %{block}]" for value, block in values))


def _checked(
    w: _Writer, i: int, given: str, predicted: str, kept: str, keep: bool, alone: bool, place: int, at: int
) -> tuple[str, str]:
    """Input i as the law takes it, and its bit if it is bad.

    A good sample of a signal that moves takes the short way; all others, and the start, go through ``check``. The
    check's numbers are those from ``place`` on, and it remembers from ``at`` on.
    """
    limit, hold, forget = (w.load("%numbers", place + part) for part in range(3))
    last, repeats, _, last_error, refused, *late = (w.load("%state", at + part) for part in range(REMEMBERED))
    error = w.make(f"fsub double {given}, {predicted}")
    size, change = w.size(error), w.size(w.make(f"fsub double {error}, {last_error}"))
    bound = w.larger(limit, w.times(late[0], LEARNED))
    sudden = w.larger(w.times(limit, SUDDEN), w.times(late[1], LARGER))
    usual = w.usable(given)
    for condition in (
        w.usable(predicted),
        w.make(f"fcmp ole double {size}, {bound}"),
        w.make(f"fcmp ole double {change}, {sudden}"),
        w.make(f"fcmp one double {given}, {last}"),
        w.make(f"fcmp ogt double {repeats}, 0.0"),
        w.make(f"fcmp olt double {refused}, {hold}"),
    ):
        usual = w.make(f"and i1 {usual}, {condition}")
    w.lines.append(f"br i1 {usual}, label %good{i}, label %other{i}, !prof !0")
    w.label(f"good{i}")
    found = (size, change, w.smaller(repeats, hold))
    late = [
        w.larger(new, w.make(f"fmul double {forget}, {old}")) for new, old in zip(found, late, strict=True)
    ]
    for part, value in enumerate((given, "1.0", last_error, error, "0.0", *late)):
        w.store(value, "%state", at + part)
    w.lines.append(f"br label %taken{i}")
    w.label(f"other{i}")
    arguments = ", ".join(f"double {x}" for x in (given, predicted, limit, hold, forget))
    memory = w.at("%state", at)
    verdict = w.make(
        f"call i64 inttoptr (i64 {check.address} to ptr)(ptr {memory}, {arguments}, i64 {int(alone)})"
    )
    if not keep:
        kept = w.make(f"select i1 {w.usable(predicted)}, double {predicted}, double {kept}")
    replaced = w.make(f"icmp sgt i64 {verdict}, {START_AGAIN}")
    value = w.make(f"select i1 {replaced}, double {kept}, double {given}")
    good = w.make(f"icmp eq i64 {verdict}, {USE}")
    bad = w.make(f"select i1 {good}, i64 0, i64 {1 << i}")
    w.lines.append(f"br label %taken{i}")
    w.label(f"taken{i}")
    value = w.make(f"phi double [{given}, %good{i}], [{value}, %other{i}]")
    return value, w.make(f"phi i64 [0, %good{i}], [{bad}, %other{i}]")


def _filled(
    w: _Writer, shape: LawShape, j: int, place: int, v: list[str], faults: str
) -> tuple[str, str, str]:
    """The input of check j, accepted unless it is missing, and its bit if it is; the prediction is made only then.

    The last good value takes its place where an input that the prediction needs is bad itself. Third: what is kept.
    """
    i, keep, *_ = shape.checks[j]
    columns = shape.rows[shape.n_curves + shape.n_outputs + shape.n_states + j]
    needed = sum(1 << u for u in range(shape.n_inputs) if shape.n_states + u in columns)
    given, kept, before = w.load("%inputs", i), v[shape.n_states + i], w.block
    usable, used = w.usable(given), kept
    w.lines.append(f"br i1 {usable}, label %taken{i}, label %missing{i}, !prof !0")
    w.label(f"missing{i}")
    if not keep:
        predicted = _row(w, columns, place, v)
        sure = w.make(f"icmp eq i64 {w.make(f'and i64 {faults}, {needed}')}, 0")
        sure = w.make(f"and i1 {sure}, {w.usable(predicted)}")
        used = w.make(f"select i1 {sure}, double {predicted}, double {kept}")
    w.lines.append(f"br label %taken{i}")
    w.label(f"taken{i}")
    value, kept = (w.make(f"phi double [{given}, %{before}], [{x}, %missing{i}]") for x in (used, kept))
    return value, w.make(f"phi i64 [0, %{before}], [{1 << i}, %missing{i}]"), kept


def _source(shape: LawShape) -> str:
    w, n_known = _Writer(), shape.n_states + shape.n_inputs
    starts = [0]
    for columns in shape.rows:
        starts.append(starts[-1] + len(columns))
    z_at = starts[-1]
    points = [len(slopes) - 1 for slopes in shape.slopes]
    w_at = z_at + sum(points)
    slope_at = w_at + sum(points)
    checks_at = slope_at + sum(points) + shape.n_curves
    v = [w.load("%state", i) for i in range(n_known)]
    checked, faults = {i for i, *_ in shape.checks}, "0"
    kept_of: dict[int, str] = {}  # where it is not what the law takes

    def curve(i: int) -> None:
        before = sum(points[:i])
        z = _row(w, shape.rows[i], starts[i], v)
        v.append(_curve(w, i, shape.slopes[i], z_at + before, w_at + before, slope_at + before + i, z))

    for i in range(shape.n_inputs):
        if i not in checked:
            given = w.load("%inputs", i)
            good = w.usable(given)
            v[shape.n_states + i] = w.make(
                f"select i1 {good}, double {given}, double {v[shape.n_states + i]}"
            )
            faults = w.make(f"or i64 {faults}, {w.make(f'select i1 {good}, i64 0, i64 {1 << i}')}")
    for i in range(shape.n_early):
        curve(i)
    expected, at = shape.n_curves + shape.n_outputs + shape.n_states, n_known
    for j, (i, keep, alone, missing_only) in enumerate(shape.checks):
        row = expected + j
        if missing_only:
            value, bad, kept_of[i] = _filled(w, shape, j, starts[row], v, faults)
        else:
            predicted, kept = _row(w, shape.rows[row], starts[row], v), v[shape.n_states + i]
            given, place = w.load("%inputs", i), checks_at + 3 * j
            value, bad = _checked(w, i, given, predicted, kept, keep, alone, place, at)
            at += REMEMBERED
        v[shape.n_states + i] = value
        faults = w.make(f"or i64 {faults}, {bad}")
    for i in range(shape.n_early, shape.n_curves):
        curve(i)
    for i in range(shape.n_outputs):
        row = shape.n_curves + i
        w.store(_row(w, shape.rows[row], starts[row], v), "%outputs", i)
    after = []
    for i in range(shape.n_states):
        row = shape.n_curves + shape.n_outputs + i
        after.append(_row(w, shape.rows[row], starts[row], v))
    for i in range(shape.n_inputs):
        after.append(kept_of.get(i, v[shape.n_states + i]))
    for i, value in enumerate(after):
        w.store(value, "%state", i)
    w.lines.append(f"ret i64 {faults}")
    pointers = ", ".join(f"ptr noalias %{name}" for name in ("numbers", "state", "inputs", "outputs"))
    body = "\n".join(w.lines)
    return (
        f"declare double @llvm.fabs.f64(double)\ndefine i64 @step({pointers}) nounwind {{\nentry:\n{body}\n}}\n"
        '!0 = !{!"branch_weights", i32 1000, i32 1}\n'
    )


class _Code(NamedTuple):
    address: int
    engine: Any  # keeps the code in memory


#: Codes made so far. None is ever dropped: laws keep the address alone.
_CODES: dict[LawShape, _Code] = {}
_MAKING = threading.Lock()


def step_code(shape: LawShape) -> _Code:
    """The compiled step of all laws of a shape: int64 step(numbers, state, inputs, outputs)."""
    with _MAKING:
        if shape not in _CODES:
            _CODES[shape] = _compiled(shape)
        return _CODES[shape]


def _compiled(shape: LawShape) -> _Code:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(_source(shape))
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=2
    )
    engine = llvm.create_mcjit_compiler(module, target)
    engine.finalize_object()
    return _Code(engine.get_function_address("step"), engine)
