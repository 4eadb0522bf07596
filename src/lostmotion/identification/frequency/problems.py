"""Warnings of the frequency response and its fit, each with a remedy."""

from __future__ import annotations

from ...errors import Problem


def hole_in_time(step: float, usual: float) -> Problem:
    """Largest and mean step, s."""
    got = f"a step of {1e3 * step:.4g} ms among steps of {1e3 * usual:.4g} ms"
    remedy = "Samples are missing: choose a window without the gap."
    return Problem.warning("frequency_response: time", got, "an even time axis", remedy)


def few_segments(segments: int, length: float, least: int) -> Problem:
    """``length`` of a segment, s."""
    got = f"{segments} segments of {length:.3g} s"
    remedy = "Record longer or take shorter segments: coherence and bands are unreliable."
    return Problem.warning("frequency_response", got, f"at least {least}", remedy)


def no_reference() -> Problem:
    got = "a recording with a speed set-point, so perhaps under speed control, and no reference"
    remedy = "Feedback biases this estimate: give reference='speed_reference' or the dither's channel."
    return Problem.warning("frequency_response", got, "a reference for recordings in closed loop", remedy)


def outside_the_band(name: str, frequency: float, low: float, high: float) -> Problem:
    """A zero or pole, Hz."""
    expected = f"a {name} between {low:.4g} and {high:.4g} Hz"
    remedy = "Widen the band or excite more there: inertias and stiffness depend on it."
    if name == "pole":
        remedy += " They are not identified; a rigid drive has none."
    return Problem.warning(f"two_mass_fit: {name}", f"{frequency:.4g} Hz, outside the band", expected, remedy)


def no_mode() -> Problem:
    got = "a response that a rigid drive fits as well, but for noise"
    remedy = "Inertias and stiffness are not identified; a rigid drive has none. Else excite more around zero and pole."
    return Problem.warning("two_mass_fit", got, "a torsional mode", remedy)


def resonance_too_sharp(width: float, resolution: float) -> Problem:
    """Both in Hz."""
    got = f"a resonance {width:.3g} Hz wide at a resolution of {resolution:.3g} Hz"
    remedy = "Take longer segments: the damping comes out too large."
    return Problem.warning("two_mass_fit: damping", got, "a resolution of at most half that width", remedy)
