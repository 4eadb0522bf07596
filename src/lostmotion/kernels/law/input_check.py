"""Which sample of a checked input is not believed: the rule of ``systems.InputCheck``, sample by sample."""

from __future__ import annotations

from numba import cfunc, types

#: An input outside ±INPUT_BOUND (NaN and infinity included) is replaced. Chosen: far above any physical value, and far
#: enough below the largest single-precision number (3.4e38) to multiply it by a gain.
INPUT_BOUND = 1e30

#: A jump is an error beyond the limit and LEARNED times the largest of late, or a change of the error, away from the
#: prediction, beyond SUDDEN times the limit and LARGER times the largest of late (all chosen on rigs 1 to 4).
LEARNED, SUDDEN, LARGER = 1.5, 0.25, 3.0
#: The largest of late grow by no more than WIDEN times their bounds at once, and by RAISE of the first of a jump. After
#: a jump, a sample is good within CLOSER times the limit (all chosen).
WIDEN, RAISE, CLOSER = 8.0, 0.125, 0.5
#: Frozen is what came SAME times or more, while its error changed by MOVED times the largest change of late; by EARLY
#: times that if it did not come more often than the longest run of late, or USUAL times; and by less the longer it
#: lasts, down to 1/LONG. Alone: what came more often than SAME times, and RUNS times the longest run (all chosen).
SAME, MOVED, EARLY, USUAL, LONG, RUNS = 5.0, 0.75, 3.0, 8.0, 10.0, 3.0
#: A frozen sample is refused for so many times the hold time longer (chosen: 120 ms in all; filters do for 100).
LASTS = 3.0

#: Numbers that a check carries from sample to sample: the value before, how often it came in a row (negative if it was
#: bad, 0 if there is none), the error before it came first, the error of the sample before, bad samples in a row
#: (negative: of a frozen signal, beyond the hold time), and of late the largest error, the largest change of it, and
#: the longest run of one value.
REMEMBERED = 8

#: What is to be done with a checked sample.
GOOD, TAKEN, REPLACED = 0, 1, 2

_CHECK = types.int64(types.CPointer(types.float64), *[types.float64] * 5, types.int64)


@cfunc(_CHECK, cache=True)
def check(memory, given, predicted, limit, hold, forget, alone):
    """What to do with a sample of a checked input; changes what is remembered."""
    missing = not -INPUT_BOUND <= given <= INPUT_BOUND
    doubt = memory[4]
    armed = 0.0 <= doubt < hold
    frozen = False
    jump = False
    if missing or not -INPUT_BOUND <= predicted <= INPUT_BOUND:
        memory[1] = 0.0
        if not missing:
            return GOOD
    else:
        error = given - predicted
        size = abs(error)
        times = memory[1]
        same = times != 0.0 and given == memory[0]
        back = armed and -SAME < times < 0.0
        bound = max(CLOSER * limit if back else limit, LEARNED * memory[5])
        sudden = max(SUDDEN * limit, LARGER * memory[6])
        change = abs(error - memory[3]) if times > 0.0 and not same else 0.0
        jump = size > bound or (change > sudden and size > abs(memory[3]))
        if back:
            jump = jump or size >= abs(given - memory[0])
        if same:
            count = abs(times) + 1.0
            usual = max(USUAL, memory[7])
            needed = MOVED * memory[6] * (usual if count > usual else EARLY * usual)
            moved = min(abs(error - memory[2]), size) * min(max(count, usual), LONG * usual)
            often = alone != 0 and given != 0.0 and count > max(SAME, RUNS * memory[7])
            frozen = times < 0.0 or often or (count >= SAME and 0.0 < needed < moved)
            memory[1] = -count if frozen else count
        else:
            memory[2] = error
            if times > 0.0:
                memory[2] = memory[3]
                memory[7] = max(min(times, hold), forget * memory[7])
            memory[0] = given
            memory[1] = 1.0
        if jump and armed:
            memory[1] = -abs(memory[1])
            if doubt == 0.0 and size > bound:
                memory[5] += RAISE * (min(size, WIDEN * bound) - memory[5])
            elif doubt == 0.0:
                memory[6] += RAISE * (min(change, WIDEN * sudden) - memory[6])
        elif times > 0.0 and not frozen:
            memory[5] = max(min(size, WIDEN * bound), forget * memory[5])
            if not same:
                memory[6] = max(min(change, WIDEN * sudden), forget * memory[6])
        memory[3] = error
    if armed:
        if missing or frozen or jump:
            over = -1.0 if frozen else 2.0 * hold
            memory[4] = doubt + 1.0 if doubt + 1.0 < hold else over
            return REPLACED
        memory[4] = 0.0
    elif doubt < 0.0 and frozen:
        memory[4] = doubt - 1.0 if 1.0 - doubt <= LASTS * hold else 2.0 * hold
        return REPLACED
    elif jump or (doubt < 0.0 and not missing):
        memory[4] = 2.0 * hold
    elif not (missing or frozen):
        memory[4] = doubt - 1.0 if doubt > hold + 1.0 else 0.0
    if missing:
        return REPLACED
    return TAKEN if frozen else GOOD
