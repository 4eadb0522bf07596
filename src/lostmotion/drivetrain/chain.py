"""Drivetrain: a chain of inertias joined by shafts, with friction and an actuator; frozen, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments, not_negative
from ..display.numbers import quantity
from ..errors import InvalidInput
from .actuator import Actuator
from .friction import Friction
from .html_table import html_table
from .shaft import Shaft
from .short_repr import given

#: Unit of each two-mass parameter, in the order in which they are shown everywhere.
PARAMETER_UNITS: dict[str, str] = {
    "inertia_motor": "kg m2",
    "inertia_load": "kg m2",
    "stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "backlash": "rad",
    "coulomb": "Nm",
    "viscous": "Nm s/rad",
    "coulomb_motor": "Nm",
    "viscous_motor": "Nm s/rad",
    "lag": "s",
}


@checks_arguments
@dataclass(frozen=True, repr=False)
class Drivetrain:
    """A chain of inertias J1 … Jn joined by shafts, motor first, load last.

    Parameters
    ----------
    inertias : tuple of n floats, kg m2
    shafts : tuple of n − 1 Shaft
    frictions : tuple of n Friction
        Default: none anywhere.
    actuator : Actuator
    locked : {None, "motor", "load"}
        End of the chain that is held: it does not turn, or turns with a given motion.
    """

    inertias: tuple[float, ...]
    shafts: tuple[Shaft, ...] = ()
    frictions: tuple[Friction, ...] = ()
    actuator: Actuator = field(default_factory=Actuator)
    locked: str | None = None

    def __post_init__(self) -> None:
        inertias = tuple(
            not_negative(f"Drivetrain.inertias[{i}]", j, positive=True) for i, j in enumerate(self.inertias)
        )
        frictions = tuple(self.frictions) or (Friction(),) * len(inertias)
        object.__setattr__(self, "inertias", inertias)
        object.__setattr__(self, "shafts", tuple(self.shafts))
        object.__setattr__(self, "frictions", frictions)
        if not inertias or len(self.shafts) != len(inertias) - 1 or len(frictions) != len(inertias):
            raise InvalidInput(
                "Drivetrain",
                f"{len(inertias)} inertias, {len(self.shafts)} shafts, {len(frictions)} frictions",
                "n inertias, n − 1 shafts, n frictions (or none), n ≥ 1",
                "Give one shaft between each pair of neighbours.",
            )
        if self.locked not in (None, "motor", "load"):
            raise InvalidInput(
                "Drivetrain.locked", repr(self.locked), "None, 'motor' or 'load'", "Choose an end."
            )

    def __repr__(self) -> str:
        """A line for each kind of part: Python that makes the same drivetrain again."""
        parts = given(self, *([] if any(f != Friction() for f in self.frictions) else ["frictions"]))
        return "Drivetrain(" + ",\n  ".join(parts) + ")"

    def _repr_html_(self) -> str:
        title = f"Drivetrain: {quantity(self.inertia_total, 'kg m2')} in all"
        if len(self.inertias) == 2 and self.locked is None:
            title += (
                f", zero {quantity(self.zero_frequency, 'Hz')}, pole {quantity(self.pole_frequency, 'Hz')}"
            )
        held = self.locked_inertia
        return html_table(title, self.inertias, self.shafts, self.frictions, self.actuator, held)

    @property
    def locked_inertia(self) -> int | None:
        """Index of the inertia that is held."""
        return {None: None, "motor": 0, "load": len(self.inertias) - 1}[self.locked]

    @classmethod
    @checks_arguments
    def two_mass(
        cls,
        *,
        inertia_motor: float,
        inertia_load: float,
        stiffness: float,
        damping: float = 0.0,
        backlash: float = 0.0,
        coulomb: float = 0.0,
        viscous: float = 0.0,
        coulomb_motor: float = 0.0,
        viscous_motor: float = 0.0,
        lag: float = 0.0,
        torque_limit: float = math.inf,
        contact: str = "viscoelastic",
    ) -> Drivetrain:
        """Motor and load joined by one shaft; units as in ``PARAMETER_UNITS``.

        ``coulomb`` and ``viscous`` sit on the load; ``lag`` is the actuator's first-order torque lag.
        """
        return cls(
            inertias=(inertia_motor, inertia_load),
            shafts=(Shaft(stiffness, damping, backlash, contact),),
            frictions=(Friction(coulomb_motor, viscous_motor), Friction(coulomb, viscous)),
            actuator=Actuator(lag, torque_limit),
        )

    def _two_mass_only(self, what: str) -> None:
        if len(self.inertias) != 2:
            raise InvalidInput(
                f"Drivetrain.{what}",
                f"{len(self.inertias)} inertias",
                "a two-mass drivetrain",
                "Reduce it first.",
            )

    @property
    def inertia_motor(self) -> float:
        self._two_mass_only("inertia_motor")
        return self.inertias[0]

    @property
    def inertia_load(self) -> float:
        self._two_mass_only("inertia_load")
        return self.inertias[1]

    @property
    def shaft(self) -> Shaft:
        self._two_mass_only("shaft")
        return self.shafts[0]

    @property
    def stiffness(self) -> float:
        return self.shaft.stiffness

    @property
    def damping(self) -> float:
        return self.shaft.damping

    @property
    def backlash(self) -> float:
        return self.shaft.backlash

    @property
    def contact(self) -> str:
        return self.shaft.contact

    @property
    def coulomb(self) -> float:
        self._two_mass_only("coulomb")
        friction = self.frictions[1]
        return 0.5 * (friction.coulomb_plus + friction.coulomb_minus)

    @property
    def viscous(self) -> float:
        self._two_mass_only("viscous")
        return self.frictions[1].viscous

    @property
    def coulomb_motor(self) -> float:
        self._two_mass_only("coulomb_motor")
        friction = self.frictions[0]
        return 0.5 * (friction.coulomb_plus + friction.coulomb_minus)

    @property
    def viscous_motor(self) -> float:
        self._two_mass_only("viscous_motor")
        return self.frictions[0].viscous

    @property
    def lag(self) -> float:
        return self.actuator.lag

    @property
    def inertia_total(self) -> float:
        return math.fsum(self.inertias)

    @property
    def zero_frequency(self) -> float:
        """First zero of motor angle / motor torque with the gap closed and no damping, Hz (two masses)."""
        return math.sqrt(self.stiffness / self.inertia_load) / (2.0 * math.pi)

    @property
    def pole_frequency(self) -> float:
        """Torsional eigenfrequency with the gap closed and no damping, Hz (two masses)."""
        inverse = 1.0 / self.inertia_motor + 1.0 / self.inertia_load
        return math.sqrt(self.stiffness * inverse) / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """Lehr's damping ratio of the torsional mode with the gap closed (two masses)."""
        inverse = 1.0 / self.inertia_motor + 1.0 / self.inertia_load
        return 0.5 * self.damping * math.sqrt(inverse / self.stiffness)

    def linear(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A (3, 3) and B (3, 1) of ẋ = Ax + B·torque_motor with the gap closed and without Coulomb friction.

        x = (twist, speed_motor, speed_load), two masses; viscous friction is part of A, the actuator's lag is not
        (Fietzek & Rinderknecht, eq. 3).
        """
        k, d, jm, jl = self.stiffness, self.damping, self.inertia_motor, self.inertia_load
        a = [
            [0.0, 1.0, -1.0],
            [-k / jm, -(d + self.viscous_motor) / jm, d / jm],
            [k / jl, d / jl, -(d + self.viscous) / jl],
        ]
        return np.array(a), np.array([[0.0], [1.0 / jm], [0.0]])

    def parameters(self) -> dict[str, float]:
        """The two-mass parameters by name, SI."""
        return {name: float(getattr(self, name)) for name in PARAMETER_UNITS}

    def with_parameters(self, **values: Any) -> Drivetrain:
        """A two-mass copy with the named parameters of ``two_mass`` changed and all else kept.

        ``coulomb`` and ``coulomb_motor`` set both directions. A breakaway level that the new friction just above rest
        exceeds becomes None, its default.
        """
        self._two_mass_only("with_parameters")
        known = (*PARAMETER_UNITS, "torque_limit", "contact")
        unknown = sorted(set(values) - set(known))
        if unknown:
            raise InvalidInput(
                "Drivetrain.with_parameters", f"{unknown}", f"names out of {sorted(known)}", "Check it."
            )

        def given(*names: str, ending: str = "") -> dict[str, Any]:
            return {name: values[name + ending] for name in names if name + ending in values}

        motor, load = self.frictions
        inertias = {"inertia_motor": self.inertia_motor, "inertia_load": self.inertia_load}
        return replace(
            self,
            inertias=tuple((inertias | given(*inertias)).values()),
            shafts=(replace(self.shaft, **given("stiffness", "damping", "backlash", "contact")),),
            frictions=(
                motor._changed(given("coulomb", "viscous", ending="_motor")),
                load._changed(given("coulomb", "viscous")),
            ),
            actuator=replace(self.actuator, **given("lag", "torque_limit")),
        )

    def with_contact(self, contact: str) -> Drivetrain:
        """A copy with every shaft under the given contact law."""
        return replace(self, shafts=tuple(replace(shaft, contact=contact) for shaft in self.shafts))
