"""Frequency response from a recording by cross spectrum, with coherence, variance and 95 % bands."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput, Problem
from ...recording import Recording, unit_of
from . import periodic
from . import problems as problem
from .estimators import Method, direct, independent_averages, joint
from .hold_and_averaging import Sampling, sampling
from .spectra import Complexes, Floats, segment_spectra


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Output over input, with its uncertainty.

    Parameters
    ----------
    input, output : str
    unit : str
    method : str
        "H1", "H2", "Hv" or "joint".
    frequency : (m,) array, Hz
    response : (m,) complex array
        Of the continuous system: the hold of the input and the averaging of counted speeds are divided out. The images
        of sampling stay: small well below the sample rate.
    coherence : (m,) array
        Of input and output.
    variance : (m,) array
        Of the complex response, real and imaginary part together.
    margin : (m,) array
        Half width of the 95 % interval in any one direction of the complex plane.
    averages : float
        Equivalent number of independent averages of the overlapping segments.
    segments : int
    resolution : float, Hz
        1 / length of a segment.
    sampling : Sampling
        How the signals were sampled: a model is compared through ``sampling.fold``.
    problems : tuple of Problem
    """

    input: str
    output: str
    unit: str
    method: str
    frequency: Floats = field(repr=False)
    response: Complexes = field(repr=False)
    coherence: Floats = field(repr=False)
    variance: Floats = field(repr=False)
    margin: Floats = field(repr=False)
    averages: float
    segments: int
    resolution: float
    sampling: Sampling
    problems: tuple[Problem, ...]

    @property
    def magnitude(self) -> Floats:
        return np.abs(self.response)

    @property
    def phase(self) -> Floats:
        """Angle of the response, rad, −π … π."""
        return np.angle(self.response)

    @property
    def magnitude_band(self) -> tuple[Floats, Floats]:
        """95 % interval of the magnitude; its lower end is 0 where the response may vanish."""
        return np.maximum(self.magnitude - self.margin, 0.0), self.magnitude + self.margin

    @property
    def phase_margin(self) -> Floats:
        """Half width of the 95 % interval of the phase, rad; π where the response may vanish."""
        ratio = self.margin / np.maximum(self.magnitude, np.finfo(float).tiny)
        return np.where(ratio < 1.0, np.arcsin(np.minimum(ratio, 1.0)), np.pi)

    @property
    def coherence_by_chance(self) -> float:
        """Coherence that unrelated signals exceed in 5 % of all frequencies."""
        return float(1.0 - 0.05 ** (1.0 / max(self.averages - 1.0, 1e-9)))

    def band(self, low: float, high: float) -> NDArray[np.bool_]:
        """Which frequencies lie from low to high (Hz)."""
        return np.asarray((self.frequency >= low) & (self.frequency <= high))

    def as_dict(self) -> dict[str, Any]:
        """Numbers and lists, for JSON."""
        low, high = self.magnitude_band
        return {
            "input": self.input,
            "output": self.output,
            "unit": self.unit,
            "method": self.method,
            "segments": self.segments,
            "averages": self.averages,
            "resolution_hz": self.resolution,
            "frequency_hz": self.frequency.tolist(),
            "real": self.response.real.tolist(),
            "imag": self.response.imag.tolist(),
            "coherence": self.coherence.tolist(),
            "variance": self.variance.tolist(),
            "magnitude_low": low.tolist(),
            "magnitude_high": high.tolist(),
            "phase_margin_rad": self.phase_margin.tolist(),
            "problems": [problem.as_dict() for problem in self.problems],
        }


#: Share of the recording in one segment by default (option): with half overlap, nineteen segments.
SEGMENT_SHARE = 0.1
#: Fewer segments than this give a warning (option): coherence and bands are unreliable, coherence by chance is 1/6.
MIN_SEGMENTS = 6
#: A time step this many times the mean one is a hole in the recording (numerics: half way to two).
LONGEST_STEP = 1.5


@checks_arguments
def frequency_response(
    recording: Recording,
    input: str = "torque_motor",
    output: str = "angle_motor",
    method: Method = "H1",
    *,
    segment: float | None = None,
    band: tuple[float, float] | None = None,
    reference: str | None = None,
    input_held: bool | None = None,
    period: float | None = None,
) -> FrequencyResponse:
    """Output over input, by Welch's method with Hann's window, half overlap, and no straight line in a segment.

    With S the spectra of input x, output y and reference r::

        H1 = Sxy/Sxx        noise in y alone        Hv = √(Syy/Sxx)·exp(j·arg Sxy)   noise in both alike
        H2 = Syy/Syx        noise in x alone        joint = Sry/Srx                  closed loop

    Variance, n averages: H1, H2, Hv abs(H)²·(1 − γ²)/(γ²·(n − 1)) (Bendat & Piersol, Random Data, section 9.2); joint
    Srr·See/(abs(Srx)²·(n − 1)) with e = y − H·x. Bands: Student's t. They cover noise and the incoherent part of a
    nonlinearity, not the bias of a resolution too coarse for a sharp resonance.

    Parameters
    ----------
    recording : Recording
    input, output : str
        Signals. An angle that is not recorded is taken from its speed, a speed from its angle, divided or multiplied by
        j·ω: so ``angle_motor`` needs no angle sensor.
    method : {"H1", "H2", "Hv"}
    segment : float, optional, s
        Length of a segment; the resolution is its inverse. Default: a tenth of the recording.
    band : (float, float), optional, Hz
        Default: from the second line up to half the sample rate.
    reference : str, optional
        An outer signal that drives the loop and depends on no noise, such as ``speed_reference`` or a dither: the
        estimate is then joint input–output, without the bias that feedback gives H1 and H2.
    input_held : bool, optional
        Whether the input is held over each sample. Default: motor and load torque and set-points are.

    period : float, optional, s
        Of an excitation that repeats, such as a PRBS or a multisine: the periods are averaged, without window, without
        leakage, and without the first, in which the drive settles. Noise then biases neither the gain in open loop nor,
        if the reference is what repeats, that in closed loop. Lines that are not excited are left out. It replaces
        ``method``, ``segment`` and ``reference``.

    Raises
    ------
    InvalidInput
        Missing or non-finite signals, a wrong method, segments that do not fit twice, a period that is no whole number
        of samples or does not fit three times.
    """
    dt = recording.dt
    if period is not None and (segment is not None or reference is not None):
        raise InvalidInput(
            "frequency_response",
            "a period beside a segment or a reference",
            "one of them",
            "Leave the others out.",
        )
    if method not in ("H1", "H2", "Hv"):
        raise InvalidInput("frequency_response: method", repr(method), "'H1', 'H2' or 'Hv'", "Choose one.")
    wanted = SEGMENT_SHARE * len(recording) * dt if segment is None else segment
    length = round(wanted / dt) if period is None else periodic.rows(period, dt, len(recording))
    how = sampling(recording, input, output, input_held)
    x, y = _signal(recording, input), _signal(recording, how.source)
    if length < 8 or len(recording) < 2 * length:
        raise InvalidInput(
            "frequency_response: segment",
            f"{wanted:g} s",
            f"{8 * dt:g} … {0.5 * len(recording) * dt:g} s",
            "Change it.",
        )
    frequency = np.asarray(np.fft.rfftfreq(length, dt), dtype=float)
    low, high = (1.5 / (length * dt), 0.5 / dt) if band is None else band
    keep = (frequency >= low) & (frequency <= high) & (frequency > 0.0)
    if not keep.any():
        raise InvalidInput(
            "frequency_response: band",
            f"{low:g} … {high:g} Hz",
            "low < high, with a line of the spectrum between",
            "Widen it.",
        )
    frequency = frequency[keep]
    spectra = segment_spectra if period is None else periodic.spectra
    a, b = (spectra(signal, length)[:, keep] for signal in (x, y))
    averages = independent_averages(len(a)) if period is None else float(len(a))
    if period is not None:
        excited = periodic.excited(a)
        a, b, frequency = a[:, excited], b[:, excited], frequency[excited]
        response, coherence, variance = joint(a, b, np.broadcast_to(a.mean(axis=0), a.shape), averages)
    elif reference is None:
        response, coherence, variance = direct(a, b, method, averages)
    else:
        r = segment_spectra(_signal(recording, reference), length)[:, keep]
        response, coherence, variance = joint(a, b, r, averages)
    factor = how.conversion(frequency)
    from scipy.stats import t as student

    variance = variance * np.abs(factor) ** 2
    spread = float(student.ppf(0.975, max(2.0 * (averages - 1.0), 1.0)))
    return FrequencyResponse(
        input=input,
        output=output,
        unit=_unit(output, input),
        method="periods" if period is not None else method if reference is None else "joint",
        frequency=frequency,
        response=np.asarray(response * factor, dtype=complex),
        coherence=coherence,
        variance=variance,
        margin=spread * np.sqrt(0.5 * variance),
        averages=averages,
        segments=len(a),
        resolution=1.0 / (length * dt),
        sampling=how,
        problems=tuple(_problems(recording, reference if period is None else "", len(a), length * dt)),
    )


def _signal(recording: Recording, name: str) -> Floats:
    values = recording[name]
    if not np.all(np.isfinite(values)):
        raise InvalidInput(
            f"frequency_response: {name}", "NaN or infinity", "finite values", "Choose a clean window."
        )
    return values


def _unit(output: str, input: str) -> str:
    above, below = unit_of(output), unit_of(input)
    return "1" if above == below else f"{above or '1'}/({below or '1'})"


def _problems(recording: Recording, reference: str | None, segments: int, length: float) -> list[Problem]:
    problems = []
    step = float(np.max(np.diff(recording.time)))
    if step > LONGEST_STEP * recording.dt:
        problems.append(problem.hole_in_time(step, recording.dt))
    if segments < MIN_SEGMENTS:
        problems.append(problem.few_segments(segments, length, MIN_SEGMENTS))
    if reference is None and "speed_reference" in recording:
        problems.append(problem.no_reference())
    return problems
