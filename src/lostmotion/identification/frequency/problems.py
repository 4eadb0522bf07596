"""Warnings of the frequency response and its fit, each with a remedy."""

from __future__ import annotations

from ...errors import Problem


def hole_in_time(step: float, usual: float) -> Problem:
    """Largest and mean step, s."""
    return Problem(
        "warning",
        "frequency_response: time",
        f"a step of {1e3 * step:.4g} ms among steps of {1e3 * usual:.4g} ms",
        "an even time axis",
        "Samples are missing: choose a window without the gap.",
    )


def few_segments(segments: int, length: float, least: int) -> Problem:
    """``length`` of a segment, s."""
    return Problem(
        "warning",
        "frequency_response",
        f"{segments} segments of {length:.3g} s",
        f"at least {least}",
        "Record longer or take shorter segments: coherence and bands are unreliable.",
    )


def no_reference() -> Problem:
    return Problem(
        "warning",
        "frequency_response",
        "a recording with a speed set-point, so perhaps under speed control, and no reference",
        "a reference for recordings in closed loop",
        "Feedback biases this estimate: give reference='speed_reference' or the dither's channel.",
    )


def outside_the_band(name: str, frequency: float, low: float, high: float) -> Problem:
    """A zero or pole, Hz."""
    return Problem(
        "warning",
        f"two_mass_fit: {name}",
        f"{frequency:.4g} Hz, outside the band",
        f"a {name} between {low:.4g} and {high:.4g} Hz",
        "Widen the band or excite more there: inertias and stiffness depend on it.",
    )


def resonance_too_sharp(width: float, resolution: float) -> Problem:
    """Both in Hz."""
    return Problem(
        "warning",
        "two_mass_fit: damping",
        f"a resonance {width:.3g} Hz wide at a resolution of {resolution:.3g} Hz",
        "a resolution of at most half that width",
        "Take longer segments: the damping comes out too large.",
    )
