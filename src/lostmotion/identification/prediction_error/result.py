"""What an identification found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..statistics.estimates import Estimates


@dataclass(frozen=True, eq=False)
class Prediction:
    """How the fitted observer predicts the motor speed, one sample ahead.

    Parameters
    ----------
    time, speed_motor, residual : (n,) arrays
        s; predicted speed and innovation (measured − predicted), rad/s. Rows in gaps are left out; the time of a
        further recording goes on after the one before.
    rms : float, rad/s
        Root mean square of the innovations, without the first tenth of a second of each segment.
    fit : float
        1 − rms / standard deviation of the measured speed.
    iterations : int
        Gauss–Newton steps over the whole recording.
    unmodelled_frequency : float, optional, Hz
        Peak of the innovations' spectrum above the torsional mode, if one stands out.
    levels : mapping of name → float
        Rms of the innovations of each measured channel, in its own unit.
    joint_piece : (float, float), optional
        The part of the motor's inertia that sits on the shaft before the gap, and the part of the shaft's compliance
        before that, if the model needed one; values belong to the two masses with the same torsional mode.
    """

    time: NDArray[np.float64] = field(repr=False)
    speed_motor: NDArray[np.float64] = field(repr=False)
    residual: NDArray[np.float64] = field(repr=False)
    rms: float
    fit: float
    iterations: int
    unmodelled_frequency: float | None
    levels: Mapping[str, float] = field(default_factory=dict)
    joint_piece: tuple[float, float] | None = None

    @property
    def deviation(self) -> float:
        """Standard deviation of the measured speed, rad/s."""
        return float(np.std(self.speed_motor + self.residual))


@dataclass(frozen=True)
class Structure:
    """What the model of an identification consists of, and what else would predict the recording as well.

    Parameters
    ----------
    parts : tuple of str
        Such as "two masses", "a gap", "friction at the load"; empty where nothing is identified.
    others : tuple of tuple of str
        Other structures that predict about as well, each with all its parts.
    compared : bool
        Whether the second estimator compared structures at all.
    """

    parts: tuple[str, ...]
    others: tuple[tuple[str, ...], ...] = ()
    compared: bool = False

    def texts(self) -> dict[str, str]:
        """What was taken and what else would fit, each by its title."""
        others = "nothing else that was tried" if self.compared else "not compared"
        if self.others:
            others = "; ".join(dict.fromkeys(self._changed(parts) for parts in self.others))
        return {"structure": ", ".join(self.parts) or "none", "would predict as well": others}

    def _changed(self, parts: tuple[str, ...]) -> str:
        """Another structure: what it has that the own has not, and what it lacks; all of it where there is no own."""
        more = [part for part in parts if part not in self.parts]
        less = [f"without {part}" for part in self.parts if part.startswith("a ") and part not in parts]
        return ", ".join([*more, *less])


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Identification(Estimates):
    """An identified two-mass drivetrain and how well it is known.

    The values are those of the drivetrain and ``inertia_total``, which a rigid drive has as well. It is not the sum of
    the drivetrain's inertias where these keep the nameplate. Beside values, intervals, sources and problems:

    Parameters
    ----------
    drivetrain : Drivetrain
        With the contact law that was asked for. What was not identified has its nameplate value here; friction, damping
        and lag of the second estimator have their likeliest one.
    prediction : Prediction
    structure : Structure
        What the model consists of, and what else would predict as well.
    names : tuple of str
        Identified parameters in the order of ``covariance``.
    covariance : (m, m) array
        Of the logarithms of the parameters (of lag + sample time for the lag); statistical part alone.
    speed_from_counts : bool
        Whether the motor speed was taken as a mean over the sample before: as stated, else as found from its
        quantisation. Observers of the same sensor need it too.
    """

    drivetrain: Drivetrain
    prediction: Prediction
    structure: Structure
    names: tuple[str, ...] = ()
    covariance: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))
    speed_from_counts: bool = False

    def remarks(self) -> dict[str, str]:
        """Structure of the model, and what else would fit."""
        return self.structure.texts()

    def as_dict(self) -> dict[str, Any]:
        return super().as_dict() | {"structure": self.remarks()}
