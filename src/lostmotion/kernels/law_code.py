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

from numba import cfunc, types

#: An input outside ±INPUT_BOUND (NaN and infinity included) is replaced. Chosen: far above any physical value, and far
#: enough below the largest single-precision number (3.4e38) to multiply it by a gain.
INPUT_BOUND = 1e30

#: Of a check: an error beyond LEARNED times the largest of late is a jump; that one grows by no more than WIDEN times
#: the bound at once, and by RAISE of the first error of a jump (all chosen).
LEARNED, WIDEN, RAISE = 1.5, 8.0, 0.125
#: After a jump a sample is good within CLOSER times the limit. Frozen is what came SAME times while its prediction
#: moved by MOVED times the largest step of late (all chosen).
CLOSER, SAME, MOVED = 0.5, 5.0, 0.75

#: Numbers that a check carries from sample to sample: the value before, how often it came in a row (−1 after a jump),
#: the prediction when it came first, bad samples in a row, the largest error and the largest step of late.
REMEMBERED = 6

#: Slope of a curve's segment: nought, one, or any other. A flat one need not wait for the curve's argument.
FLAT, ONE, STEEP = 0, 1, 2

#: What is to be done with a checked sample.
GOOD, TAKEN, REPLACED = 0, 1, 2


class LawShape(NamedTuple):
    """What the code depends on; rows, curves and checks as in ``law.LawTables``."""

    n_states: int
    n_inputs: int
    n_curves: int
    n_outputs: int
    n_early: int  # curves that are evaluated before the inputs are checked
    rows: tuple[tuple[int, ...], ...]  # columns of the coefficients that are not zero
    slopes: tuple[tuple[int, ...], ...]  # of each curve's segments: FLAT, ONE or STEEP
    checks: tuple[tuple[int, bool], ...]  # input, and whether it keeps its last good value


_CHECK = types.int64(types.CPointer(types.float64), *[types.float64] * 5)


@cfunc(_CHECK, cache=True)
def check(memory, given, predicted, limit, hold, forget):
    """What to do with a sample of a checked input, see ``systems.InputCheck``; changes what is remembered."""
    missing = not -INPUT_BOUND <= given <= INPUT_BOUND
    doubt = memory[3]
    frozen = False
    jump = False
    if missing or not -INPUT_BOUND <= predicted <= INPUT_BOUND:
        memory[1] = 0.0
        if not missing:
            return GOOD
    else:
        error = abs(given - predicted)
        times = memory[1]
        bound = max(limit if times >= 0.0 else CLOSER * limit, LEARNED * memory[4])
        jump = error > bound
        step = 0.0
        if times > 0.0 and given == memory[0]:
            memory[1] = times + 1.0
            moved = min(abs(predicted - memory[2]), error)
            frozen = times + 1.0 >= SAME and 0.0 < MOVED * memory[5] < moved
        else:
            if times == 1.0:
                step = abs(given - memory[0])
            memory[0] = given
            memory[1] = 1.0
            memory[2] = predicted
        if jump and doubt < hold:
            memory[1] = -1.0
            if doubt == 0.0:
                memory[4] += RAISE * (min(error, WIDEN * bound) - memory[4])
        else:
            memory[4] = max(min(error, WIDEN * bound), forget * memory[4])
            if step > 0.0:
                memory[5] = max(min(step, bound), forget * memory[5])
    if doubt < hold:
        if missing or frozen or jump:
            memory[3] = doubt + 1.0 if doubt + 1.0 < hold else 2.0 * hold
            return REPLACED
        memory[3] = 0.0
    elif jump:
        memory[3] = 2.0 * hold
    elif not (missing or frozen):
        memory[3] = doubt - 1.0 if doubt > hold + 1.0 else 0.0
    if missing:
        return REPLACED
    return TAKEN if frozen else GOOD


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


def _larger(w: _Writer, a: str, b: str) -> str:
    return w.make(f"select i1 {w.make(f'fcmp ogt double {a}, {b}')}, double {a}, double {b}")


def _smaller(w: _Writer, a: str, b: str) -> str:
    return w.make(f"select i1 {w.make(f'fcmp olt double {a}, {b}')}, double {a}, double {b}")


def _checked(
    w: _Writer, i: int, given: str, predicted: str, kept: str, keep: bool, place: int, at: int
) -> tuple[str, str]:
    """Input i as the law takes it, and its bit if it is bad.

    A good sample of a signal that moves takes the short way; all others, and the start, go through ``check``. The
    check's numbers are those from ``place`` on, and it remembers from ``at`` on.
    """
    limit, hold, forget = (w.load("%numbers", place + part) for part in range(3))
    last, times, doubt, largest, steps = (w.load("%state", at + part) for part in (0, 1, 3, 4, 5))
    distance = w.make(f"call double @llvm.fabs.f64(double {w.make(f'fsub double {given}, {predicted}')})")
    bound = _larger(w, limit, w.make(f"fmul double {largest}, {_number(LEARNED)}"))
    usual = w.usable(given)
    for condition in (
        w.usable(predicted),
        w.make(f"fcmp ole double {distance}, {bound}"),
        w.make(f"fcmp one double {given}, {last}"),
        w.make(f"fcmp oge double {times}, 0.0"),
        w.make(f"fcmp olt double {doubt}, {hold}"),
    ):
        usual = w.make(f"and i1 {usual}, {condition}")
    w.lines.append(f"br i1 {usual}, label %good{i}, label %other{i}, !prof !0")
    w.label(f"good{i}")
    moved = w.make(f"call double @llvm.fabs.f64(double {w.make(f'fsub double {given}, {last}')})")
    step = _larger(w, _smaller(w, moved, bound), w.make(f"fmul double {forget}, {steps}"))
    first = w.make(f"fcmp oeq double {times}, 1.0")
    step = w.make(f"select i1 {first}, double {step}, double {steps}")
    error = _larger(w, distance, w.make(f"fmul double {forget}, {largest}"))
    for part, value in enumerate((given, "1.0", predicted, "0.0", error, step)):
        w.store(value, "%state", at + part)
    w.lines.append(f"br label %taken{i}")
    w.label(f"other{i}")
    arguments = ", ".join(f"double {x}" for x in (given, predicted, limit, hold, forget))
    memory = w.at("%state", at)
    found = w.make(f"call i64 inttoptr (i64 {check.address} to ptr)(ptr {memory}, {arguments})")
    if not keep:
        kept = w.make(f"select i1 {w.usable(predicted)}, double {predicted}, double {kept}")
    replaced = w.make(f"icmp eq i64 {found}, {REPLACED}")
    value = w.make(f"select i1 {replaced}, double {kept}, double {given}")
    good = w.make(f"icmp eq i64 {found}, {GOOD}")
    bad = w.make(f"select i1 {good}, i64 0, i64 {1 << i}")
    w.lines.append(f"br label %taken{i}")
    w.label(f"taken{i}")
    value = w.make(f"phi double [{given}, %good{i}], [{value}, %other{i}]")
    return value, w.make(f"phi i64 [0, %good{i}], [{bad}, %other{i}]")


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
    checked, faults = {i for i, _ in shape.checks}, "0"

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
    expected = shape.n_curves + shape.n_outputs + shape.n_states
    for j, (i, keep) in enumerate(shape.checks):
        predicted = _row(w, shape.rows[expected + j], starts[expected + j], v)
        place, at = checks_at + 3 * j, n_known + REMEMBERED * j
        kept = v[shape.n_states + i]
        v[shape.n_states + i], bad = _checked(w, i, w.load("%inputs", i), predicted, kept, keep, place, at)
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
    for i, value in enumerate([*after, *v[shape.n_states : n_known]]):
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
