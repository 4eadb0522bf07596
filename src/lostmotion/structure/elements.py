"""The parts of a torsional chain: discs, shaft segments, couplings and gears, in the order of the drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..argument_checks import checks_arguments
from ..errors import InvalidInput

#: Steel: shear modulus in Pa and density in kg/m³ (physics: usual handbook values).
STEEL_SHEAR_MODULUS, STEEL_DENSITY = 79.3e9, 7850.0


def _positive(where: str, value: float, zero_allowed: bool = False) -> None:
    if not math.isfinite(value) or value < 0.0 or (value == 0.0 and not zero_allowed):
        expected = "zero or a positive number" if zero_allowed else "a positive number"
        raise InvalidInput(where, repr(value), f"{expected} in SI units", "Check the sign and the unit.")


@checks_arguments
@dataclass(frozen=True)
class Disc:
    """A rigid inertia (kg m²) at its position in the chain."""

    name: str
    inertia: float

    def __post_init__(self) -> None:
        _positive(f"Disc {self.name!r}: inertia", self.inertia)


@checks_arguments
@dataclass(frozen=True)
class Coupling:
    """A massless spring of given stiffness (Nm/rad); its inertias are discs before and after it."""

    name: str
    stiffness: float

    def __post_init__(self) -> None:
        _positive(f"Coupling {self.name!r}: stiffness", self.stiffness)


@checks_arguments
@dataclass(frozen=True)
class ShaftSegment:
    """A round shaft of constant cross-section, divided into equal finite elements.

    Parameters
    ----------
    name : str
    length, outer_diameter, inner_diameter : float, m
    shear_modulus : float, Pa
    density : float, kg/m³
    elements : int
        Number of linear elements with consistent mass matrix; the error of a frequency falls with its square.
    """

    name: str
    length: float
    outer_diameter: float
    inner_diameter: float = 0.0
    shear_modulus: float = STEEL_SHEAR_MODULUS
    density: float = STEEL_DENSITY
    elements: int = 4

    def __post_init__(self) -> None:
        where = f"ShaftSegment {self.name!r}"
        for field in ("length", "outer_diameter", "shear_modulus", "density"):
            _positive(f"{where}: {field}", getattr(self, field))
        _positive(f"{where}: inner_diameter", self.inner_diameter, zero_allowed=True)
        if self.inner_diameter >= self.outer_diameter or self.elements < 1:
            raise InvalidInput(
                where,
                f"diameters {self.outer_diameter} and {self.inner_diameter} m, {self.elements} elements",
                "an outer diameter above the inner one and at least one element",
                "Diameters, not radii, in m.",
            )

    @property
    def polar_moment(self) -> float:
        """Second polar moment of area π/32·(D⁴ − d⁴), m⁴."""
        return math.pi / 32.0 * (self.outer_diameter**4 - self.inner_diameter**4)

    @property
    def stiffness(self) -> float:
        """Stiffness of the whole segment G·I/L, Nm/rad."""
        return self.shear_modulus * self.polar_moment / self.length

    @property
    def inertia(self) -> float:
        """Inertia of the whole segment ρ·I·L, kg m²."""
        return self.density * self.polar_moment * self.length


@checks_arguments
@dataclass(frozen=True)
class Gear:
    """A rigid gear stage: all that follows turns at 1/ratio of the speed before it.

    Parameters
    ----------
    name : str
    ratio : float
        Speed before over speed behind; negative if the direction of rotation is reversed.
    inertia_in, inertia_out : float, kg m²
        Of the gear wheels on the shaft before and behind.
    """

    name: str
    ratio: float
    inertia_in: float = 0.0
    inertia_out: float = 0.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.ratio) or self.ratio == 0.0:
            raise InvalidInput(
                f"Gear {self.name!r}: ratio", repr(self.ratio), "a number other than 0", "Give it."
            )
        _positive(f"Gear {self.name!r}: inertia_in", self.inertia_in, zero_allowed=True)
        _positive(f"Gear {self.name!r}: inertia_out", self.inertia_out, zero_allowed=True)


Part = Disc | Coupling | ShaftSegment | Gear
