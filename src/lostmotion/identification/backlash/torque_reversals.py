"""Whether the backlash can be identified from a recording: only if the shaft torque reverses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import Problem
from ...recording import Recording
from . import problems as problem

#: A torque counts as being on one side of zero when it is there by this many standard deviations of its noise
#: (numerics: by chance one sample of normal noise in 1.7 million is).
NOISE_FACTOR = 5.0


@dataclass(frozen=True)
class BacklashExcitation:
    """Judgement of one recording.

    Attributes
    ----------
    excited : bool or None
        Whether the shaft torque reverses; None where no shaft torque was recorded or estimated.
    reversals : int
    low, high : float, Nm
        Smallest and largest shaft torque; NaN where there is none.
    noise : float, Nm
        Standard deviation of the torque's white noise, from its second differences.
    signal : str
        The signal judged.
    problems : tuple of Problem
    """

    excited: bool | None
    reversals: int
    low: float
    high: float
    noise: float
    signal: str
    problems: tuple[Problem, ...]


@checks_arguments
def backlash_excited(recording: Recording, *, signal: str = "torque_shaft") -> BacklashExcitation:
    """Judge by the shaft torque, measured or estimated, whether the gap is crossed.

    The torque reverses where it goes from beyond +5 to beyond −5 standard deviations of its noise or back.
    A bias of the torque sensor is not known here and shifts the judgement by as much.

    Parameters
    ----------
    recording : Recording
    signal : str
        Its shaft torque, Nm; where it is missing, ``signal`` + "_estimated" is taken if present.
    """
    name = signal if signal in recording else f"{signal}_estimated"
    if name not in recording:
        nan = float("nan")
        return BacklashExcitation(None, 0, nan, nan, nan, signal, (problem.no_shaft_torque(signal),))
    torque = recording[name]
    noise = _white_noise(torque)
    sides = np.sign(torque) * (np.abs(torque) > NOISE_FACTOR * noise)
    sides = sides[sides != 0.0]
    reversals = int(np.count_nonzero(np.diff(sides)))
    low, high = float(torque.min()), float(torque.max())
    problems = () if reversals else (problem.never_reverses(name, low, high),)
    return BacklashExcitation(reversals > 0, reversals, low, high, noise, name, problems)


def _white_noise(values: NDArray[np.float64]) -> float:
    """Standard deviation of white noise on a smooth signal: second differences have √6 times as much.

    Their median makes it blind to rare impacts (1.4826 of it is one standard deviation of a normal one).
    """
    if values.size < 3:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(values, 2))) / np.sqrt(6.0))
