"""Drivetrain: inertias joined by shafts with stiffness, damping and backlash, with friction; frozen, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput
from .recording import unit_of

Contact = Literal["viscoelastic", "dead_zone", "limited", "clipped", "physical"]
CONTACT_LAWS: tuple[str, ...] = get_args(Contact)

#: Backlash up to this total angle (rad) counts as none under every law (DESIGN: section 1).
NO_BACKLASH = 1e-10


def _check(where: str, value: float, positive: bool = False) -> float:
    value = float(value)
    if not math.isfinite(value) or value < 0.0 or (positive and value == 0.0):
        expected = "a positive number" if positive else "zero or a positive number"
        raise InvalidInput(where, repr(value), f"{expected} in SI units", "Check the sign and the unit.")
    return value


@dataclass(frozen=True)
class Shaft:
    """One elastic shaft with backlash.

    Parameters
    ----------
    stiffness : float, Nm/rad
    damping : float, Nm s/rad
    backlash : float, rad
        The **total** free angle; at most 1e-10 rad counts as none.
    contact : {"viscoelastic", "dead_zone", "limited", "clipped", "physical"}
        The torque law, with dz(z) = z − clip(z, ±backlash/2) and rate = d(twist)/dt:

        - ``viscoelastic``: k·dz(twist + (d/k)·rate); continuous and passive;
        - ``dead_zone``: k·dz(twist) + d·rate, the damper acts inside the gap too (Fietzek & Rinderknecht, eq. 3);
        - ``limited``: k·dz(twist) + clip(d·rate, ±abs(k·dz(twist))); continuous, never pulls (Modelica's
          ElastoBacklash);
        - ``clipped``: k·dz(twist) + d·rate in contact, cut at zero so that it only pushes; zero in the gap; the
          torque jumps at an impact (Modelica's ElastoBacklash2);
        - ``physical``: the shaft's own angle is a state that relaxes in the gap with rate k/d
          (Nordin, Galić & Gutman 1997).
    """

    stiffness: float
    damping: float = 0.0
    backlash: float = 0.0
    contact: str = "viscoelastic"

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", _check("Shaft.stiffness", self.stiffness, positive=True))
        object.__setattr__(self, "damping", _check("Shaft.damping", self.damping))
        object.__setattr__(self, "backlash", _check("Shaft.backlash", self.backlash))
        if self.contact not in CONTACT_LAWS:
            raise InvalidInput("Shaft.contact", repr(self.contact), f"one of {CONTACT_LAWS}", "Choose a law.")

    @property
    def has_backlash(self) -> bool:
        return self.backlash > NO_BACKLASH


@dataclass(frozen=True)
class Friction:
    """Friction of one inertia: set-valued at rest, Coulomb + Stribeck + viscous when it turns.

    At speed w ≠ 0 the torque against the motion is ``coulomb + stribeck(abs(w)) + viscous·abs(w)``. At rest the
    inertia stays at rest, exactly, until the torque on it exceeds the breakaway level.

    Parameters
    ----------
    coulomb : float or (float, float), Nm
        One level, or one for positive and one for negative speed.
    viscous : float, Nm s/rad
    breakaway : float, optional, Nm
        Torque that starts the motion; default: the friction torque just above rest.
    stribeck : tuple of (speed, torque)
        Extra torque above Coulomb at the given absolute speeds (rad/s, Nm): the first speed is 0, the last
        torque is 0, linear between, zero beyond.
    """

    coulomb: float | tuple[float, float] = 0.0
    viscous: float = 0.0
    breakaway: float | None = None
    stribeck: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.coulomb, (tuple, list)):
            plus, minus = self.coulomb
            levels = (_check("Friction.coulomb[0]", plus), _check("Friction.coulomb[1]", minus))
            object.__setattr__(self, "coulomb", levels)
        else:
            object.__setattr__(self, "coulomb", _check("Friction.coulomb", self.coulomb))
        object.__setattr__(self, "viscous", _check("Friction.viscous", self.viscous))
        points = tuple(
            (_check("Friction.stribeck", s), _check("Friction.stribeck", t)) for s, t in self.stribeck
        )
        increasing = all(b[0] > a[0] for a, b in zip(points, points[1:], strict=False))
        if points and (points[0][0] != 0.0 or points[-1][1] != 0.0 or not increasing):
            raise InvalidInput(
                "Friction.stribeck",
                repr(points),
                "speeds increasing from 0 and a last torque of 0",
                "Give the torque above the Coulomb level at each absolute speed.",
            )
        object.__setattr__(self, "stribeck", points)
        if self.breakaway is not None:
            level = _check("Friction.breakaway", self.breakaway)
            if level < max(self.level_at_rest) * (1.0 - 1e-12):
                raise InvalidInput(
                    "Friction.breakaway",
                    f"{level} Nm",
                    f"at least the friction just above rest, {max(self.level_at_rest)} Nm",
                    "Raise it, or lower coulomb or stribeck.",
                )
            object.__setattr__(self, "breakaway", level)

    @property
    def coulomb_plus(self) -> float:
        """Coulomb level at positive speed, Nm."""
        return self.coulomb[0] if isinstance(self.coulomb, tuple) else self.coulomb

    @property
    def coulomb_minus(self) -> float:
        """Coulomb level at negative speed, Nm (a positive number)."""
        return self.coulomb[1] if isinstance(self.coulomb, tuple) else self.coulomb

    @property
    def level_at_rest(self) -> tuple[float, float]:
        """Friction torque just above rest for positive and negative speed, Nm."""
        extra = self.stribeck[0][1] if self.stribeck else 0.0
        return (self.coulomb_plus + extra, self.coulomb_minus + extra)

    @property
    def sticks(self) -> bool:
        """Whether there is a set-valued part: anything but viscous friction."""
        return max(self.level_at_rest) > 0.0 or bool(self.breakaway)

    def _changed(self, values: dict[str, Any]) -> Friction:
        """A copy with some fields changed; the breakaway level is dropped where it is now too low."""
        changed = replace(self, **values, breakaway=None)
        if self.breakaway is None or self.breakaway < max(changed.level_at_rest):
            return changed
        return replace(changed, breakaway=self.breakaway)

    def torque(self, speed: float) -> float:
        """Friction torque (Nm) against the motion at a speed ≠ 0 (rad/s); 0 at rest."""
        if speed == 0.0:
            return 0.0
        magnitude = abs(speed)
        extra = 0.0
        for (s0, t0), (s1, t1) in zip(self.stribeck, self.stribeck[1:], strict=False):
            if s0 <= magnitude < s1:
                extra = t0 + (t1 - t0) * (magnitude - s0) / (s1 - s0)
        level = self.coulomb_plus if speed > 0.0 else self.coulomb_minus
        return math.copysign(level + extra + self.viscous * magnitude, speed)


@dataclass(frozen=True)
class Actuator:
    """The drive's torque actuator.

    Parameters
    ----------
    lag : float, s
        First-order lag of the torque.
    torque_limit : float, Nm
        Largest set-point.
    rate_limit : float, Nm/s
        Largest change of the set-point, which acts from sample to sample as in a digital drive.
    """

    lag: float = 0.0
    torque_limit: float = math.inf
    rate_limit: float = math.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "lag", _check("Actuator.lag", self.lag))
        if not self.torque_limit > 0.0:
            raise InvalidInput(
                "Actuator.torque_limit",
                repr(self.torque_limit),
                "a positive number in Nm",
                "Use inf for no limit.",
            )
        if not self.rate_limit > 0.0:
            raise InvalidInput(
                "Actuator.rate_limit",
                repr(self.rate_limit),
                "a positive number in Nm/s",
                "Use inf for no limit.",
            )


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


@dataclass(frozen=True)
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
        End of the chain that is held: it does not turn, or turns as it is told.
    """

    inertias: tuple[float, ...]
    shafts: tuple[Shaft, ...] = ()
    frictions: tuple[Friction, ...] = ()
    actuator: Actuator = field(default_factory=Actuator)
    locked: str | None = None

    def __post_init__(self) -> None:
        inertias = tuple(
            _check(f"Drivetrain.inertias[{i}]", j, positive=True) for i, j in enumerate(self.inertias)
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

    @property
    def locked_inertia(self) -> int | None:
        """Index of the inertia that is held."""
        return {None: None, "motor": 0, "load": len(self.inertias) - 1}[self.locked]

    @classmethod
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


@dataclass(frozen=True)
class Gear:
    """A gear without losses: refers what turns behind it to the side before it, and back.

    Behind a gear of ratio i = speed before / speed behind, angles and speeds are i times smaller and torques i times
    larger. Referred to the side before it, inertias, stiffnesses, dampings and viscous frictions are divided by
    i², torques by i, angles (backlash) and speeds multiplied by i: the chain then runs as one of a single speed.

    Parameters
    ----------
    ratio : float
        Speed before the gear over speed behind it; negative where the gear reverses the motion.
    """

    ratio: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.ratio) or self.ratio == 0.0:
            raise InvalidInput(
                "Gear.ratio", repr(self.ratio), "a finite number other than 0", "Give n before / n behind."
            )

    def refer(self, drivetrain: Drivetrain) -> Drivetrain:
        """A drivetrain that stands behind the gear, as it is seen from before it."""
        i = abs(self.ratio)
        return replace(
            drivetrain,
            inertias=tuple(j / i**2 for j in drivetrain.inertias),
            shafts=tuple(
                replace(s, stiffness=s.stiffness / i**2, damping=s.damping / i**2, backlash=s.backlash * i)
                for s in drivetrain.shafts
            ),
            frictions=tuple(self._friction(f) for f in drivetrain.frictions),
            actuator=replace(
                drivetrain.actuator,
                torque_limit=drivetrain.actuator.torque_limit / i,
                rate_limit=drivetrain.actuator.rate_limit / i,
            ),
        )

    def refer_back(self, drivetrain: Drivetrain) -> Drivetrain:
        """The inverse of ``refer``: a referred drivetrain in the units of the side behind the gear."""
        return Gear(1.0 / self.ratio).refer(drivetrain)

    def join(self, before: Drivetrain, shaft: Shaft, behind: Drivetrain) -> Drivetrain:
        """One chain, referred to the side before: `before`, the gear, `shaft` at its output, then `behind`.

        `shaft` is given in the units of the side behind, like `behind`. The actuator is that of `before`.
        """
        link = self.refer(Drivetrain((1.0, 1.0), (shaft,))).shafts[0]
        referred = self.refer(behind)
        return Drivetrain(
            (*before.inertias, *referred.inertias),
            (*before.shafts, link, *referred.shafts),
            (*before.frictions, *referred.frictions),
            before.actuator,
            behind.locked if behind.locked == "load" else before.locked,
        )

    def behind(self, name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """A simulated signal of the referred part (``speed_load``, ``torque_shaft_2`` …) as it is behind the gear.

        By the unit of its name: angles and speeds are divided by the ratio, torques multiplied; energies stay.
        """
        factors = {"rad": 1.0 / self.ratio, "rad/s": 1.0 / self.ratio, "Nm": self.ratio, "J": 1.0}
        unit = unit_of(name)
        if unit not in factors:
            raise InvalidInput(
                "Gear.behind",
                repr(name),
                "the name of an angle, a speed, a torque or an energy",
                "Rename it.",
            )
        return np.asarray(factors[unit] * values)

    def _friction(self, friction: Friction) -> Friction:
        i = abs(self.ratio)
        levels = (friction.coulomb_plus / i, friction.coulomb_minus / i)
        return Friction(
            coulomb=levels if self.ratio > 0.0 else levels[::-1],
            viscous=friction.viscous / i**2,
            breakaway=None if friction.breakaway is None else friction.breakaway / i,
            stribeck=tuple((speed * i, torque / i) for speed, torque in friction.stribeck),
        )
