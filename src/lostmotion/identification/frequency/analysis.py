"""From a recording to its frequency response and two-mass fit, as the command line shows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import Problem
from ...recording import Recording
from .response import FrequencyResponse, Method, frequency_response
from .two_mass_fit import TwoMassFit, two_mass_fit
from .two_mass_response import OUTPUTS


@dataclass(frozen=True, eq=False)
class FrequencyAnalysis:
    """A frequency response and, where there is one, its two-mass fit."""

    response: FrequencyResponse
    fit: TwoMassFit | None

    @property
    def problems(self) -> tuple[Problem, ...]:
        return self.response.problems + (self.fit.problems if self.fit else ())

    def as_dict(self) -> dict[str, Any]:
        """Numbers and lists, for JSON."""
        return {"response": self.response.as_dict(), "two_mass_fit": self.fit.as_dict() if self.fit else None}


@checks_arguments
def frequency_analysis(
    recording: Recording,
    input: str = "torque_motor",
    output: str = "angle_motor",
    method: Method = "H1",
    *,
    segment: float | None = None,
    band: tuple[float, float] | None = None,
    fit_band: tuple[float, float] | None = None,
    reference: str | None = None,
    start: Drivetrain | None = None,
) -> FrequencyAnalysis:
    """``frequency_response`` and, for a motor torque and an output of the motor (or with a start), ``two_mass_fit``.

    Parameters
    ----------
    fit_band : (float, float), optional, Hz
        Lines for the fit; default: all of ``band``.

    Other parameters: see ``frequency_response`` and ``two_mass_fit``.
    """
    response = frequency_response(
        recording, input, output, method, segment=segment, band=band, reference=reference
    )
    identifiable = output.endswith("_motor") or start is not None
    fits = input == "torque_motor" and output in OUTPUTS and identifiable
    return FrequencyAnalysis(response, two_mass_fit(response, band=fit_band, start=start) if fits else None)
