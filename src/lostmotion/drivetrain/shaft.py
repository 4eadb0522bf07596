"""Shaft: stiffness, damping and backlash, under one of five contact laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from ..argument_checks import checks_arguments, not_negative
from ..errors import InvalidInput
from .short_repr import call_of

Contact = Literal["viscoelastic", "dead_zone", "limited", "clipped", "physical"]
CONTACT_LAWS: tuple[str, ...] = get_args(Contact)

#: Backlash up to this total angle (rad) counts as none under every law (DESIGN: section 1).
NO_BACKLASH = 1e-10


@checks_arguments
@dataclass(frozen=True, repr=False)
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
        object.__setattr__(self, "stiffness", not_negative("Shaft.stiffness", self.stiffness, positive=True))
        object.__setattr__(self, "damping", not_negative("Shaft.damping", self.damping))
        object.__setattr__(self, "backlash", not_negative("Shaft.backlash", self.backlash))
        if self.contact not in CONTACT_LAWS:
            raise InvalidInput("Shaft.contact", repr(self.contact), f"one of {CONTACT_LAWS}", "Choose a law.")

    def __repr__(self) -> str:
        return call_of(self)

    @property
    def has_backlash(self) -> bool:
        return self.backlash > NO_BACKLASH
