"""Laws and plant joined by their signals: blocks on a diagonal, outputs sideways, inputs from above and below."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

from ...curves import PiecewiseLinear
from ...display.numbers import digits
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...recording import unit_of
from ...systems import DiscreteSystem, Stepper
from .curve_icons import HEIGHT, WIDTH, abreast, draw_icon, grouped
from .law_parts import ROOM, single_sum, with_unit
from .sheet import LARGE, LINE, QUIET, SMALL, Sheet, text_width
from .symbols import rotor, rotor_height, shaft

Law = DiscreteSystem | Stepper

#: Up to so many blocks, all orders are tried (numerics: 720).
MOST_ORDERED = 6
#: Room around and between pictures in a block, and the plant's rotors: distance and size as a share (option).
PAD, STEP, SHARE = 8.0, 74.0, 0.5


@dataclass(frozen=True, eq=False)
class _Block:
    """One law or the plant: what it reads and makes, and what stands in its block."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    about: str
    curves: tuple[PiecewiseLinear, ...] = ()
    gains: tuple[float, ...] = ()
    plant: Drivetrain | None = None

    def labels(self, signals: Sequence[str]) -> list[str]:
        """Some of its inputs with their units, and with their gains where it sums them once."""
        gains = dict(zip(self.inputs, self.gains, strict=False))
        return [with_unit(s) + (f" × {digits(gains[s])}" if s in gains else "") for s in signals]

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in points."""
        wide = max(text_width(self.name, LARGE, "bold"), text_width(self.about, SMALL))
        high = LINE * (LARGE + SMALL) + 2.0 * PAD
        if self.curves:
            pictures = len(grouped(self.curves))
            columns = abreast(pictures)
            wide = max(wide, columns * (WIDTH + PAD) - PAD)
            high += math.ceil(pictures / columns) * (HEIGHT + PAD)
        if self.plant is not None:
            wide = max(wide, STEP * (len(self.plant.inertias) - 1) + 20.0)
            high += 60.0
        return wide + 2.0 * PAD + 8.0, high


def draw_joined(
    sheet: Sheet, laws: Sequence[Law], plant: Drivetrain | None, outputs: Sequence[str] | None
) -> None:
    """The diagram; its blocks stand in the order that needs the fewest signals back."""
    blocks = _blocks(laws, plant)
    read = {signal for block in blocks for signal in block.inputs}
    made = [signal for block in blocks for signal in block.outputs]
    leaving = tuple(signal for signal in made if signal not in read) if outputs is None else tuple(outputs)
    for wrong, expected in (
        (sorted({s for s in made if made.count(s) > 1}), "one maker of each signal"),
        (sorted(set(leaving) - set(made)), f"names out of {made}"),
    ):
        if wrong:
            raise InvalidInput("plot.block_diagram: outputs", f"{wrong}", expected, "Rename with renamed().")
    _Chart(sheet, _ordered(blocks), leaving).draw()


def _blocks(laws: Sequence[Law], plant: Drivetrain | None) -> list[_Block]:
    found = []
    for law in laws:
        about = "stepper"
        curves = law.curves if isinstance(law, DiscreteSystem) else ()
        if isinstance(law, DiscreteSystem):
            counts = ((len(law.states), "state"), (len(curves), "curve"))
            about = ", ".join(f"{n} {word}{'s' * (n != 1)}" for n, word in counts if n) or "gains"
        gains = tuple(single_sum(law)) if isinstance(law, DiscreteSystem) else ()
        found.append(_Block(law.name.replace("_", " "), law.inputs, law.outputs, about, curves, gains))
    if plant is not None:
        made = {signal for law in laws for signal in law.outputs}
        needed = dict.fromkeys(signal for law in laws for signal in law.inputs if signal not in made)
        n = len(plant.inertias)
        torques = {"torque_motor", "torque_load", *(f"torque_{i + 1}" for i in range(n))}
        sensed = tuple(s for s in needed if unit_of(s) and not s.endswith(("_reference", "_estimated")))
        inputs = tuple(signal for law in laws for signal in law.outputs if signal in torques)
        found.append(_Block("plant", inputs, sensed, f"{n} inertia{'s' * (n != 1)}", plant=plant))
    return found


def _ordered(blocks: list[_Block]) -> list[_Block]:
    """The order with the fewest links back, of those the one nearest to the given."""

    def links_back(order: tuple[_Block, ...]) -> int:
        return sum(
            not set(late.outputs).isdisjoint(early.inputs)
            for i, early in enumerate(order)
            for late in order[i + 1 :]
        )

    if len(blocks) > MOST_ORDERED:
        return blocks
    orders: list[tuple[_Block, ...]] = list(permutations(blocks))
    best = min(orders, key=links_back)
    return list(best)


class _Chart:
    """Row i and column i cross in block i; what goes from block i to block j stands in row i and column j."""

    def __init__(self, sheet: Sheet, blocks: list[_Block], leaving: tuple[str, ...]) -> None:
        self.sheet, self.blocks = sheet, blocks
        count = range(len(blocks))
        made = {signal for block in blocks for signal in block.outputs}
        self.cells = {
            (i, j): [s for s in blocks[i].outputs if s in blocks[j].inputs]
            for i in count
            for j in count
            if i != j
        }
        self.cells |= {(-1, j): [s for s in blocks[j].inputs if s not in made] for j in count}
        self.leaving = [[s for s in block.outputs if s in leaving] for block in blocks]
        self.cells = {(i, j): blocks[j].labels(signals) for (i, j), signals in self.cells.items() if signals}
        self.x = _middles([self._width(j) for j in count])
        self.y = [-y for y in _middles([self._height(i) for i in (-1, *count)])]

    def _width(self, j: int) -> float:
        cells = [_cell_size(lines)[0] for (_, column), lines in self.cells.items() if column == j]
        return max([self.blocks[j].size[0], *cells])

    def _height(self, i: int) -> float:
        cells = [_cell_size(lines)[1] for (row, _), lines in self.cells.items() if row == i]
        own = [] if i < 0 else [self.blocks[i].size[1], _cell_size(self.leaving[i])[1]]
        return max([0.0, *own, *cells])

    def _row(self, i: int) -> float:
        return self.y[i + 1]

    def draw(self) -> None:
        for (i, j), lines in self.cells.items():
            self._link(i, j)
            wide, high = _cell_size(lines)
            x, y = self.x[j], self._row(i)
            self.sheet.box(
                x, y, wide, high, facecolor="white", edgecolor="#b5b5b5", linewidth=0.7, round_by=3.0
            )
            self.sheet.column(x, y + 0.5 * high - 3.0, lines, size=SMALL)
        for i, block in enumerate(self.blocks):
            _draw_block(self.sheet, block, self.x[i], self._row(i))
            if self.leaving[i]:
                self._leave(i)

    def _link(self, i: int, j: int) -> None:
        """Along the row of block i to the column of block j, and along that to block j."""
        x, y, target = self.x[j], self._row(i), self._row(j)
        down = i < j
        tip = target + (0.5 if down else -0.5) * self.blocks[j].size[1]
        corner = [(x, y), (x, tip)]
        if i >= 0:
            side = 0.5 * self.blocks[i].size[0]
            corner.insert(0, (self.x[i] + (side if down else -side), y))
        self.sheet.line(*corner, arrow=True)

    def _leave(self, i: int) -> None:
        lines = [with_unit(s) for s in self.leaving[i]]
        end = self.x[-1] + 0.5 * self._width(len(self.blocks) - 1) + 1.5 * ROOM
        y = self._row(i)
        self.sheet.line((self.x[i] + 0.5 * self.blocks[i].size[0], y), (end, y), arrow=True)
        self.sheet.column(end + 5.0, y + 0.5 * LINE * SMALL * len(lines), lines, size=SMALL, ha="left")


def _middles(sizes: Sequence[float]) -> list[float]:
    """Middles of parts of these sizes in a line, with room between them."""
    found, end = [], 0.0
    for size in sizes:
        found.append(end + 0.5 * size)
        end += size + ROOM
    return found


def _cell_size(lines: Sequence[str]) -> tuple[float, float]:
    wide = max((text_width(line, SMALL) for line in lines), default=0.0)
    return wide + 10.0, LINE * SMALL * len(lines) + 6.0


def _draw_block(sheet: Sheet, block: _Block, x: float, y: float) -> None:
    wide, high = block.size
    sheet.box(x, y, wide, high, zorder=1.5)
    top = y + 0.5 * high - PAD
    top -= sheet.column(x, top, [block.name], size=LARGE, weight="bold")
    top -= sheet.column(x, top, [block.about], size=SMALL, color=QUIET)
    groups = grouped(block.curves)
    for i, group in enumerate(groups):
        columns = abreast(len(groups))
        row, column = divmod(i, columns)
        at = x + (column - 0.5 * (columns - 1)) * (WIDTH + PAD)
        draw_icon(sheet, group.curve, at, top - PAD - 0.5 * HEIGHT - row * (HEIGHT + PAD))
    if block.plant is not None:
        _draw_plant(sheet, block.plant, x, top - 32.0)


def _draw_plant(sheet: Sheet, plant: Drivetrain, x: float, y: float) -> None:
    """The chain without its values."""
    n, largest = len(plant.inertias), max(plant.inertias)
    places = [x + STEP * (i - 0.5 * (n - 1)) for i in range(n)]
    for at, inertia in zip(places, plant.inertias, strict=True):
        rotor(sheet, at, y, SHARE * rotor_height(inertia, largest), 8.0)
    for i, part in enumerate(plant.shafts):
        ends = places[i] + 4.0, places[i + 1] - 4.0
        crossing = part.contact == "dead_zone"
        shaft(
            sheet, *ends, y, damped=part.damping > 0.0, backlash=part.has_backlash, damper_spans_gap=crossing
        )
