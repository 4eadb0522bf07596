"""Which sample of a checked input is used: the rule of ``systems.InputCheck``, for laws with a fixed gain.

The words are those of ``estimators.verdicts``, which says why the estimators have a rule of their own. The exported C
and, for good samples, the laws' machine code hold copies of this rule.
"""

from __future__ import annotations

from numba import types

from ..estimators.layout import record, size
from ..estimators.records import reads
from ..estimators.verdicts import FROZEN, INPUT_BOUND, JUMP, MISSING, START_AGAIN, USE
from ..jit import cfunc, njit

#: A jump is an error beyond the limit and LEARNED times the largest recent one, or a change of the error, away from the
#: prediction, beyond SUDDEN times the limit and LARGER times the largest recent one. Calibration: virtual rigs 1 to 4.
LEARNED, SUDDEN, LARGER = 1.5, 0.25, 3.0
#: The largest recent ones grow by no more than WIDEN times their bounds at once, and by RAISE of the first of a jump.
#: After a jump, a sample is good within CLOSER times the limit. Calibration: virtual rigs 1 to 4.
WIDEN, RAISE, CLOSER = 8.0, 0.125, 0.5
#: Frozen: unchanged for SAME samples or more, while the error changed by MOVED times the largest recent change; by
#: EARLY times that while the run is no longer than the longest recent one, or USUAL; and by less the longer it lasts,
#: down to 1/LONG. Alone: more than SAME samples, and RUNS times the longest recent run. Calibration: virtual rigs 1 to
#: 4.
SAME, MOVED, EARLY, USUAL, LONG, RUNS = 5.0, 0.75, 3.0, 8.0, 10.0, 3.0
#: Option: a frozen sample is rejected for so many times the hold time longer (120 ms in all; estimators do for 100).
LASTS = 3.0

#: What a check carries from sample to sample: the value before, how often it came in a row (negative if it was bad, 0
#: if there is none), the error before it came first, the error of the sample before, bad samples in a row (negative: of
#: a frozen signal, beyond the hold time; from ``hold`` on every sample is used), and the recent largest error, largest
#: change of it, and longest run of one value.
CHECK_MEMORY = record(
    "value", "repeats", "error_before", "error", "refused", "largest_error", "largest_change", "longest_run"
)
REMEMBERED = size(CHECK_MEMORY)
_memory = reads(CHECK_MEMORY)


@njit(cache=True, inline="always")
def _usable(value):
    """False for NaN, which fails both comparisons, for infinity, and for absurd values."""
    return -INPUT_BOUND <= value <= INPUT_BOUND


@njit(cache=True, inline="always")
def _is_frozen(m, given, error, alone):
    """Whether a value that came again is frozen."""
    count = abs(m.repeats) + 1.0
    usual = max(USUAL, m.longest_run)
    needed = MOVED * m.largest_change * (usual if count > usual else EARLY * usual)
    moved = min(abs(error - m.error_before), abs(error)) * min(max(count, usual), LONG * usual)
    often = alone != 0 and given != 0.0 and count > max(SAME, RUNS * m.longest_run)
    return m.repeats < 0.0 or often or (count >= SAME and 0.0 < needed < moved)


@njit(cache=True, inline="always")
def _count_repeats(m, given, error, frozen, same, hold, forget):
    """How often the value came in a row, and from which error on."""
    if same:
        count = abs(m.repeats) + 1.0
        m.repeats = -count if frozen else count
        return
    m.error_before = error
    if m.repeats > 0.0:
        m.error_before = m.error
        m.longest_run = max(min(m.repeats, hold), forget * m.longest_run)
    m.value = given
    m.repeats = 1.0


@njit(cache=True, inline="always")
def _judge(m, given, error, limit, hold, forget, alone, armed):
    """Whether a sample is frozen, and whether it is a jump; learns what is usual."""
    far, repeats = abs(error), m.repeats
    same = repeats != 0.0 and given == m.value
    back = armed and -SAME < repeats < 0.0
    bound = max(CLOSER * limit if back else limit, LEARNED * m.largest_error)
    sudden = max(SUDDEN * limit, LARGER * m.largest_change)
    change = abs(error - m.error) if repeats > 0.0 and not same else 0.0
    jump = far > bound or (change > sudden and far > abs(m.error))
    if back:
        jump = jump or far >= abs(given - m.value)
    frozen = same and _is_frozen(m, given, error, alone)
    _count_repeats(m, given, error, frozen, same, hold, forget)
    if jump and armed:
        m.repeats = -abs(m.repeats)
        if m.refused == 0.0 and far > bound:
            m.largest_error += RAISE * (min(far, WIDEN * bound) - m.largest_error)
        elif m.refused == 0.0:
            m.largest_change += RAISE * (min(change, WIDEN * sudden) - m.largest_change)
    elif repeats > 0.0 and not frozen:
        m.largest_error = max(min(far, WIDEN * bound), forget * m.largest_error)
        if not same:
            m.largest_change = max(min(change, WIDEN * sudden), forget * m.largest_change)
    m.error = error
    return frozen, jump


@njit(cache=True, inline="always")
def _verdict(m, missing, frozen, jump, armed, hold):
    """What is done with the sample; counts those that were refused."""
    refused = m.refused
    bad = MISSING if missing else FROZEN if frozen else JUMP
    if armed:
        if missing or frozen or jump:
            over = -1.0 if frozen else 2.0 * hold
            m.refused = refused + 1.0 if refused + 1.0 < hold else over
            return bad
        m.refused = 0.0
    elif refused < 0.0 and frozen:
        m.refused = refused - 1.0 if 1.0 - refused <= LASTS * hold else 2.0 * hold
        return bad
    elif jump or (refused < 0.0 and not missing):
        m.refused = 2.0 * hold
    elif not (missing or frozen):
        m.refused = refused - 1.0 if refused > hold + 1.0 else 0.0
    if missing:
        return MISSING
    return START_AGAIN if frozen else USE


@cfunc(types.int64(types.CPointer(types.float64), *[types.float64] * 5, types.int64), cache=True)
def check(memory, given, predicted, limit, hold, forget, alone):
    """What is done with a sample of a checked input; changes what is remembered."""
    m, missing, frozen, jump = _memory(memory), not _usable(given), False, False
    armed = 0.0 <= m.refused < hold
    if missing or not _usable(predicted):
        m.repeats = 0.0
        if not missing:
            return USE
    else:
        frozen, jump = _judge(m, given, given - predicted, limit, hold, forget, alone, armed)
    return _verdict(m, missing, frozen, jump, armed, hold)
