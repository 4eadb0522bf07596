"""A sample in which a contact or a friction changes, for the contact-switching filter.

The change is sought in eighths of the sample, eighths of these, and so on; the rest goes on in the new state. Other
parameters that hardly differ follow the sub-steps that were found.
"""

from __future__ import annotations

from ..jit import njit
from .columns import INNER, WIDE, copy
from .holding import holds
from .motion import closing, follow_errors, moved, next_contact, reversed_motion, slopes_of_friction
from .sample_parts import DIGIT, MOST, part_number, parts, shape_mean, until_change
from .transitions import BLOCK, HALF, LEAD, PART


@njit(forceinline=True, **INNER)
def _share_until(contact, after, c, of, law, ends, x, y):
    """Share of a sub-step from state x to y until the contact changes, by linear interpolation: continuous in the
    parameters."""
    half, lead = c[of + HALF], c[of + LEAD]
    first = x[0] + lead * (x[ends[0]] - x[ends[1]])
    last = y[0] + lead * (y[ends[0]] - y[ends[1]])
    if contact == 0:
        first, last = closing(first, x[0], law), closing(last, y[0], law)
    edge = (contact if contact != 0 else after) * half
    return min(max((edge - first) / (last - first), 0.0), 1.0) if last != first else 1.0


@njit(forceinline=True, **INNER)
def _advance(x, y, share):
    """State x after a share of the way to y."""
    for i in range(WIDE):
        x[i] += share * (y[i] - x[i])


@njit(forceinline=True, **INNER)
def _contact_after(contact, c, law, ends, y):
    """Contact in state y after a sub-step."""
    return next_contact(contact, y[0] + c[LEAD] * (y[ends[0]] - y[ends[1]]), y[0], c[HALF], law)


@njit(forceinline=True, **INNER)
def _note(path, step, done, size, rest, contact):
    """One sub-step of the path."""
    path[step, 0], path[step, 1], path[step, 2], path[step, 3] = done, size, rest, contact


@njit(**INNER)
def through_changes(
    t, filled, at_rest, c, loads, finest, ramp, n, ends, law, torque, jump, contact, rest, x, y, f, work, path
):  # fmt: skip
    """A sample in which something changes, from change to change.

    x is advanced; returns contact, what rests, the share of the sample with the gap closed, the number of sub-steps,
    and which transitions at rest it lacks (0: none; else nothing is done).

    The transitions are at t[0 …], see ``sample_parts``, those of what rests at t[stuck·at_rest …] if ``filled``,
    and the model's numbers at c[0 …]; ``ends`` are the places of the speeds before and behind the gap; ``loads``: see
    ``holding``. f is filled with how an error of the state goes on over the sample, and ``path`` with the begin and
    length of each sub-step, in finest parts, what rests, and the contact after it.
    """
    half, part = c[HALF], -1.0 if ramp else c[PART]
    whole, closed_at, steps, closed, done = 1 << finest, parts(finest) * BLOCK, 0, 0, 0
    # The mean of a ramp stands for all of a sub-step.
    longest = whole >> 1 if ramp and finest > 0 else whole
    for j in range(n):
        for i in range(WIDE):
            f[j * WIDE + i] = 1.0 if i == j else 0.0
    while done < whole:
        room, digit = until_change(part, finest, done), 0
        found = room == whole == longest  # else this would not be called
        while found and (room >> digit) > MOST + 1:
            digit += DIGIT
        while room > 0:
            if not found:
                digit = 0
                while (min(room, longest) >> digit) > MOST:
                    digit += DIGIT
            begin = rest * at_rest + (closed_at if contact != 0 else 0)
            # The most units after which nothing has changed, by halving; where a change was found all are too many.
            most = (room >> digit) - 1 if found else min(room, longest) >> digit
            good, bad, count = 0, most + 1, (most + 1) >> 1 if found else most
            while bad - good > 1:
                size = count << digit
                at, edge = begin + part_number(size, finest) * BLOCK, contact * half
                u = torque + shape_mean(part, finest, done, size) * jump
                stuck = moved(t, at, c, 0, n, x, u, 0.0, edge, rest, y)
                after = _contact_after(contact, c, law, ends, y)
                same = after == contact and stuck == rest and not reversed_motion(c, 0, x, y)
                if same and rest != 0:
                    share, slant = size / whole, 0.5 * size / whole * jump if ramp else 0.0
                    same = holds(
                        loads, 1 if contact != 0 else 0, rest, c, x, u + slant, y, u - slant, edge, share
                    )
                if same:
                    good = count
                    copy(y, work)
                else:
                    bad = count
                count = (good + bad) >> 1
            if good > 0:
                size = good << digit
                copy(work, y)
                at = begin + part_number(size, finest) * BLOCK
                slopes = slopes_of_friction(c, 0, x, y)
                follow_errors(t, at, n, rest, 0, slopes, 1.0, f, work)
                copy(y, x)
                _note(path, steps, done, size, rest, contact)
                steps += 1
                closed += size if contact != 0 else 0
                done += size
                room -= size
            if bad > most and not found:
                continue
            found = True
            if digit > 0:
                room = 1 << digit
                digit -= DIGIT
                continue
            # The finest sub-step, in which it changes.
            at = (closed_at if contact != 0 else 0) + part_number(1, finest) * BLOCK
            u = torque + shape_mean(part, finest, done, 1) * jump
            rest = moved(t, at, c, 0, n, x, u, 0.0, contact * half, 0, y)
            after = _contact_after(contact, c, law, ends, y)
            share = 1.0
            if after != contact:
                share = _share_until(contact, after, c, 0, law, ends, x, y)
            follow_errors(t, at, n, 0, rest, slopes_of_friction(c, 0, x, y), share, f, work)
            _advance(x, y, share)
            if after != contact:
                contact = after
                at = (closed_at if contact != 0 else 0) + part_number(1, finest) * BLOCK
                rest = moved(t, at, c, 0, n, x, u, 0.0, contact * half, 0, y)
                follow_errors(t, at, n, 0, rest, slopes_of_friction(c, 0, x, y), 1.0 - share, f, work)
                _advance(x, y, 1.0 - share)
            if rest != 0 and not filled[rest]:
                return contact, rest, 0.0, 0, rest
            _note(path, steps, done, 1, 0, contact)
            steps += 1
            closed += 1 if contact != 0 else 0
            done += 1
            break
    return contact, rest, closed / whole, steps, 0


@njit(**INNER)
def along_path(
    t, begin, at_rest, c, of, finest, ramp, n, ends, law, torque, jump, contact, path, steps, x, y
):
    """The same sample with a model that hardly differs, by the sub-steps that were found: x is advanced.

    Its transitions are at t[begin …], those at rest at t[begin + stuck·at_rest …], its numbers at c[of …].
    """
    half, part, closed_at = c[of + HALF], -1.0 if ramp else c[of + PART], parts(finest) * BLOCK
    for i in range(steps):
        done, size, rest, after = path[i, 0], path[i, 1], path[i, 2], path[i, 3]
        place = part_number(size, finest) * BLOCK
        u = torque + shape_mean(part, finest, done, size) * jump
        at, edge = place + (closed_at if contact != 0 else 0), contact * half
        moved(t, begin + rest * at_rest + at, c, of, n, x, u, 0.0, edge, rest, y)
        if after == contact:
            copy(y, x)
            continue
        share = _share_until(contact, after, c, of, law, ends, x, y)
        _advance(x, y, share)
        contact = after
        at = place + (closed_at if contact != 0 else 0)
        moved(t, begin + at, c, of, n, x, u, 0.0, contact * half, 0, y)
        _advance(x, y, 1.0 - share)
