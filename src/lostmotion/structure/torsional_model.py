"""TorsionalModel: mass and stiffness matrix of a torsional structure, with names and gear ratios of its nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .elements import Coupling, Disc, Gear, Part, ShaftSegment

Floats = NDArray[np.float64]

#: Modal damping ratio of the paper's finite-element model (Fietzek & Rinderknecht, section II).
DAMPING_RATIO = 0.02
#: Largest asymmetry of a matrix, relative to its largest entry, that counts as rounding (numerics).
ASYMMETRY = 1e-9


@checks_arguments
@dataclass(frozen=True, eq=False)
class TorsionalModel:
    """M·φ̈ + K·φ = torques, all angles and torques referred to the first shaft.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays, kg m² and Nm/rad
        Symmetric; mass positive definite, stiffness positive semidefinite. Copied, read-only.
    names : tuple of n str, optional
        Default "1", "2", …
    ratios : (n,) array, optional
        Speed of the first shaft over that of the node's own shaft (gears); default 1.
    damping_ratio : float
        Lehr's ratio of every eigenmode.

    Raises
    ------
    InvalidInput
        If shapes differ, a matrix is not symmetric, or the mass matrix is not positive definite.
    """

    mass: Floats
    stiffness: Floats
    names: tuple[str, ...] = ()
    ratios: Floats = None  # type: ignore[assignment]
    damping_ratio: float = DAMPING_RATIO

    def __post_init__(self) -> None:
        mass, stiffness = _symmetric("mass", self.mass), _symmetric("stiffness", self.stiffness)
        n = len(mass)
        ratios = np.array(np.ones(n) if self.ratios is None else self.ratios, dtype=float)
        ratios.setflags(write=False)
        names = tuple(self.names) or tuple(str(i + 1) for i in range(n))
        for field, value in (("mass", mass), ("stiffness", stiffness), ("ratios", ratios), ("names", names)):
            object.__setattr__(self, field, value)
        if stiffness.shape != mass.shape or ratios.shape != (n,) or len(names) != n or len(set(names)) != n:
            raise InvalidInput(
                "TorsionalModel",
                f"mass {mass.shape}, stiffness {stiffness.shape}, ratios {ratios.shape}, names {names}",
                "matrices of one size, a ratio and a name of its own for each node",
                "Check sizes and names.",
            )
        if not 0.0 <= self.damping_ratio < 1.0:
            raise InvalidInput("damping_ratio", repr(self.damping_ratio), "0 … 1", "0.02 is usual.")
        _check_definite(mass, stiffness)

    def node(self, place: str | int) -> int:
        """Index of a node given by name, or by index from 0 (negative: from the end)."""
        if isinstance(place, str) and place in self.names:
            return self.names.index(place)
        if isinstance(place, int | np.integer) and -len(self.names) <= place < len(self.names):
            return int(place) % len(self.names)
        raise InvalidInput("node", repr(place), f"a name out of {self.names}, or an index", "Check it.")

    @property
    def inertia_total(self) -> float:
        """Inertia of rigid rotation, referred to the first shaft, kg m²."""
        return math.fsum(self.mass.ravel())

    def inertia_sides(self, gap: str | int) -> tuple[float, float]:
        """Inertia up to and including node ``gap``, and behind it, referred to the first shaft, kg m²."""
        rows = self.mass.sum(axis=1)
        i = self.node(gap) + 1
        return math.fsum(rows[:i]), math.fsum(rows[i:])


@checks_arguments
def assemble(parts: Sequence[Part], *, damping_ratio: float = DAMPING_RATIO) -> TorsionalModel:
    """The finite-element model of a chain of parts, given in the order of the drawing.

    A disc adds its inertia to the current node. A coupling adds a node, a shaft segment as many as it has elements. A
    gear is rigid and refers all that follows to the first shaft (inertia and stiffness over ratio²). A node has the
    name of its first disc, else ``<shaft>.<element>``, ``<coupling>.end`` or, before the first part, ``start``.

    Element of length l: stiffness G·I/l·[[1, −1], [−1, 1]], consistent mass ρ·I·l/6·[[2, 1], [1, 2]].

    Raises
    ------
    InvalidInput
        If a node has no inertia (two couplings without a disc between), or the parts do not form a chain.
    """
    chain = _Chain()
    for part in parts:
        chain.add(part)
    n = len(chain.names)
    mass, stiffness = np.zeros((n, n)), np.zeros((n, n))
    for i, inertia in chain.discs:
        mass[i, i] += inertia
    for i, k, inertia in chain.springs:
        stiffness[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass[i : i + 2, i : i + 2] += inertia / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    empty = [name for name, m in zip(chain.names, mass.diagonal(), strict=True) if m == 0.0]
    if empty:
        raise InvalidInput("assemble", f"no inertia at {empty}", "inertia at every node", "Add discs there.")
    return TorsionalModel(mass, stiffness, tuple(chain.names), np.array(chain.ratios), damping_ratio)


@checks_arguments
def from_drivetrain(drivetrain: Drivetrain, *, damping_ratio: float = DAMPING_RATIO) -> TorsionalModel:
    """The linear structure of a drivetrain, every gap closed; nodes "1" (motor) … "n" (load)."""
    n = len(drivetrain.inertias)
    parts: list[Part] = []
    for i, inertia in enumerate(drivetrain.inertias):
        parts.append(Disc(str(i + 1), inertia))
        if i < n - 1:
            parts.append(Coupling(f"shaft {i + 1}", drivetrain.shafts[i].stiffness))
    return assemble(parts, damping_ratio=damping_ratio)


class _Chain:
    """Nodes, discs (node, inertia) and springs (left node, stiffness, inertia), referred to the first shaft."""

    def __init__(self) -> None:
        self.names, self.ratios = ["start"], [1.0]
        self.discs: list[tuple[int, float]] = []
        self.springs: list[tuple[int, float, float]] = []
        self._ratio = 1.0

    def add(self, part: Part) -> None:
        here, square = len(self.names) - 1, self._ratio**2
        match part:
            case Disc():
                if all(node != here for node, _ in self.discs):
                    self.names[here] = part.name
                self.discs.append((here, part.inertia / square))
            case Coupling():
                self._spring(f"{part.name}.end", part.stiffness / square, 0.0)
            case ShaftSegment():
                m = part.elements
                for e in range(m):
                    self._spring(
                        f"{part.name}.{e + 1}", m * part.stiffness / square, part.inertia / m / square
                    )
            case Gear():
                # Both wheels are on one node: rigid teeth add no degree of freedom.
                self._ratio *= part.ratio
                both = part.inertia_in / square + part.inertia_out / self._ratio**2
                self.discs.append((here, both))
            case _:
                raise InvalidInput(
                    "assemble", f"a {type(part).__name__}", "parts of a chain", "See Disc, Coupling."
                )

    def _spring(self, name: str, stiffness: float, inertia: float) -> None:
        self.springs.append((len(self.names) - 1, stiffness, inertia))
        self.names.append(name)
        self.ratios.append(self._ratio)


def _symmetric(name: str, values: ArrayLike) -> Floats:
    matrix = np.array(values, dtype=float)
    square = matrix.ndim == 2 and matrix.shape[0] == matrix.shape[1] and matrix.size > 0
    if not square or not np.all(np.isfinite(matrix)):
        raise InvalidInput(
            f"TorsionalModel.{name}", f"shape {matrix.shape}", "a finite square matrix", "Check it."
        )
    if np.max(np.abs(matrix - matrix.T)) > ASYMMETRY * np.max(np.abs(matrix)):
        raise InvalidInput(
            f"TorsionalModel.{name}", "an asymmetric matrix", "a symmetric one", "Check its source."
        )
    matrix = 0.5 * (matrix + matrix.T)
    matrix.setflags(write=False)
    return matrix


def _check_definite(mass: Floats, stiffness: Floats) -> None:
    if np.linalg.eigvalsh(mass)[0] <= 0.0:
        raise InvalidInput(
            "TorsionalModel.mass",
            "a matrix that is not positive definite",
            "inertia at every node",
            "Condense it.",
        )
    lowest = float(np.linalg.eigvalsh(stiffness)[0])
    if lowest < -ASYMMETRY * max(float(np.max(np.abs(stiffness))), 1e-300):
        raise InvalidInput(
            "TorsionalModel.stiffness",
            f"eigenvalue {lowest:.3g}",
            "no negative eigenvalue",
            "Check the signs.",
        )
