"""What an identification by prediction error tells its user: every message, in the order of what it is about."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...drivetrain import PARAMETER_UNITS, Drivetrain
from ...errors import Problem
from ..statistics.estimates import UNITS

#: Values that differ by less are one (numerics: a logarithm and back).
SAME = 1e-6
_EXCITE = {
    "backlash": "Record reversals of the shaft torque: torque of both signs at steady speed.",
    "stiffness": "Record torque with content near the zero and the pole of the drivetrain.",
    "damping": "Record torque with content near the pole, with the gap closed.",
    "inertia_total": "Record accelerations in both directions, more often than the load torque changes.",
    "coulomb": "Record steady speeds in both directions, with more torque than the friction holds.",
    "viscous": "Record two speed levels in each direction, far apart.",
    "lag": "Record torque with content above the pole.",
}
#: Where no value of the two masses is identified: the slow motion alone may tell their sum.
_NOTHING = "Nothing is identified beyond the total inertia"

# The recording.


def gaps(segments: int, recordings: int, left_out: float) -> Problem:
    """``left_out``, s."""
    got = f"{segments} segments in {recordings} recording(s), {left_out:.3g} s left out"
    remedy = "The observer starts anew after each gap: one long segment tells more than many short ones."
    return Problem.warning("recording", got, "no gaps", remedy)


def rows_joined(step: float, deviation: float, rows: int) -> Problem:
    """Step of the counts and standard deviation of the speed, rad/s."""
    got = f"counts of {step:.3g} rad/s in a speed that varies by {deviation:.3g} rad/s"
    remedy = f"{rows} rows each are taken as one. A finer encoder tells more."
    return Problem.warning("speed_motor", got, "finer ones", remedy)


def few_samples_per_period(samples: float, least: float) -> Problem:
    got = f"{samples:.1f} samples per period of the torsional mode"
    return Problem.warning("recording.time", got, f"at least {least:.0f}", "Record at a higher rate.")


def inertia_contradicts_torque(seen: float, found: float) -> Problem:
    """Inertia by the acceleration at low frequency, and as found, kg m2."""
    got = f"a low-frequency acceleration as of {seen:.3g} kg m2"
    remedy = "Check sign, scale and unit in the channels of torque and speed."
    return Problem.warning("torque_motor", got, f"about {found:.3g} kg m2", remedy)


# The prediction.


def unexplained(excess: float, most: float) -> Problem:
    """Innovations over the sensor's noise."""
    return Problem(
        "warning",
        "identification",
        f"innovations {excess:.1f} times the sensor's noise",
        f"at most {most:.0f} times",
        f"{_NOTHING}, as no model explains the recording. Record without load torque, or measure more.",
    )


def rigid() -> Problem:
    return Problem(
        "warning",
        "identification",
        "a rigid drive that predicts as well",
        "torsional motion above the noise",
        f"{_NOTHING}, neither its parts nor stiffness, damping or backlash: this recording shows no torsion. Record "
        "torque near the pole, or use rigid_drive for the friction.",
    )


def contradicted() -> Problem:
    return Problem(
        "warning",
        "identification",
        "other values that predict clearly better, and leave more than the sensor's noise",
        "one model that explains the recording",
        f"{_NOTHING}. Record more reversals of the torque, without load torque, or measure more.",
    )


def wrong_minimum(name: str, found: float, nameplate: float, factor: float) -> Problem:
    far = far_from_nameplate(name, found, nameplate, factor)
    return replace(
        far,
        remedy=f"{_NOTHING}: values so far away are rarely right. {far.remedy} Or measure {name} in another way.",
    )


def others_as_well(names: Sequence[str]) -> Problem:
    return Problem(
        "warning",
        ", ".join(names),
        "other values that predict as well or better",
        "one set of values",
        "The intervals contain both, or the value is not identified. Record more reversals, or measure more.",
    )


def still_moving() -> Problem:
    remedy = "Check the values under [nameplate], and the sign of the torque (sign in its channel)."
    return Problem.warning("identification", "a fit that was still moving", "convergence", remedy)


def not_white(excess: float, most: float) -> Problem:
    """``excess``: slow innovations over white noise's share of them."""
    got = f"innovations with {excess:.1f} times white noise's share of slow ones"
    remedy = (
        "Friction, load or shaft are not as the model has them. If the motor has friction of its own, give "
        "coulomb_motor under [nameplate]; if a torque acts on the load, set load_torque = true under [identify]. The "
        "intervals allow for a coloured residual."
    )
    return Problem.warning("identification", got, f"at most {most:g}", remedy)


def too_coarse(level: float, deviation: float, most: float) -> Problem:
    """Rms of the innovations and standard deviation of the speed, rad/s; ``most`` is the largest share."""
    got = f"innovations of {level:.3g} rad/s in a speed that varies by {deviation:.3g} rad/s"
    remedy = (
        f"{_NOTHING}. Check the values under [nameplate]; if they are right, the resolution is too low: take "
        "a finer encoder, or record faster motion with more torque."
    )
    return Problem.warning("speed_motor", got, f"at most {100.0 * most:g} %", remedy)


def unmodelled_mode(frequency: float) -> Problem:
    """Hz."""
    got = f"prediction errors with a peak at {frequency:.0f} Hz"
    remedy = (
        "A further inertia or shaft: the intervals allow for it. If the drive rings there under a default law, "
        "give smaller kp and ki, or slower poles, under [law]."
    )
    return Problem.warning("identification", got, "no resonance beyond that of motor and load", remedy)


def second_minimum(found: Drivetrain, other: Mapping[str, float]) -> Problem:
    """Other values predict the recording nearly as well: those that differ by more than a tenth are named (chosen)."""
    texts = [
        f"{name} {other[name]:.4g} {PARAMETER_UNITS[name]}"
        for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")
        if abs(np.log(other[name] / getattr(found, name))) > 0.1
    ]
    got = f"a second minimum: {', '.join(texts)} predict nearly as well"
    remedy = (
        "Name what the nameplate knows well in fixed = [...] under [identify], or record more reversals and a wider "
        "band of torque."
    )
    return Problem.warning("identification", got, "one minimum", remedy)


def laws_alike(gain: float, certainty: float, least: float) -> Problem:
    """Two contact laws: gain of the better one and the least that counts, as fractions; standard deviations."""
    got = f"laws whose predictions differ by {100.0 * gain:.2g} % ({certainty:.1f} standard deviations)"
    remedy = (
        "They cannot be distinguished here: keep the viscoelastic law, or record faster crossings of the gap."
    )
    return Problem.warning("contact", got, f"at least {100.0 * least:g} % in most of the recording", remedy)


# Single parameters.


def not_excited(name: str, used: float, nameplate: float) -> Problem:
    """``used``: the value that the model has instead."""
    value = f"{used:g} {UNITS[name]}"
    if not math.isclose(used, nameplate, rel_tol=SAME):
        instead = f"The model has the likeliest value, {value}, which may be far off."
    elif nameplate:
        instead = f"The nameplate's {value} is used instead."
    else:
        instead = f"The nameplate lacks it: {value} is used."
    remedy = f"{_EXCITE.get(name, 'Record more torque.')} {instead}"
    return Problem.warning(name, "a recording that does not tell it", "excitation", remedy)


def no_gap(bound: float, nameplate: float) -> Problem:
    """Largest gap that may be there, and that of the nameplate, rad."""
    expected = f"the nameplate's {nameplate:.3g} rad" if nameplate else "a gap, or none"
    remedy = "The drivetrain has no gap, and the law none to cross. If there is one, record more reversals."
    return Problem.warning("backlash", f"no backlash above {bound:.2g} rad (95 %)", expected, remedy)


def far_from_nameplate(name: str, found: float, nameplate: float, factor: float) -> Problem:
    unit = PARAMETER_UNITS[name]
    expected = f"within a factor of {factor:g} of the nameplate's {nameplate:.4g} {unit}"
    remedy = "Check the value under [nameplate], and scale and unit in the channel of the torque."
    return Problem.warning(name, f"{found:.4g} {unit}", expected, remedy)


def correlated(names: Sequence[str], largest: float, limit: float) -> Problem:
    remedy = (
        "Only combinations of them are known well: name the one that the nameplate knows in fixed = [...] under "
        "[identify], or record a richer torque."
    )
    return Problem.warning(", ".join(names), f"correlations up to {largest:.3f}", f"below {limit}", remedy)
