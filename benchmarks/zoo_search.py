"""What the search of ``identify`` misses: its lowest candidate beside a descent from the true chain, over equal rows.

    python benchmarks/zoo_search.py development --first 5561 --drives 50

Where the true chain is clearly likelier, the drive is in the recording, and the search has not found it. The descent
has all inertias on the shafts up to two, the largest gap, friction at both ends, lag and delay of the drive; it tries
all contact laws and both ways of the torque between rows.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from unittest.mock import patch

import numpy as np
from shared import parser_of
from zoo_tables import CORE

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.identification.prediction_error.contact_switching.filter import LAWS
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Candidate,
    cost_of,
    fitted_rates,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import FRICTIONS, INDEX
from lostmotion.identification.prediction_error.contact_switching.search.descents import Search

#: Rise of the log likelihood from which on the true chain is clearly likelier (chosen: four times that by which a
#: candidate is better at all, ``likelihood_ratio.LEAST_RISE``).
CLEARLY = 40.0
#: Lag and delay of a torque that has neither, in sample times (numerics: inside of the search's bounds).
LITTLE = 0.3


class _Searched(Exception):
    """The search has ended; what comes after it is not needed."""


def searched(drive: lm.rig.Drive) -> tuple[Search, Candidate] | None:
    """The search and its lowest candidate; None where the fit stands, or the recording is refused."""
    caught: list[tuple[Search, Candidate]] = []
    rivals = Search.rivals

    def spy(search: Search, fit: Candidate) -> list[Candidate]:
        caught.append((search, min([fit, *rivals(search, fit)], key=cost_of)))
        raise _Searched

    with patch.object(Search, "rivals", spy), contextlib.suppress(_Searched, LostMotionError):
        lm.identify(drive.recording, start=drive.nameplate)
    return caught[0] if caught else None


def true_values(drive: lm.rig.Drive, dt: float) -> tuple[dict[str, float], bool, bool]:
    """Values of the filter's parameters, and whether the third inertia and the fourth are behind the gap."""
    chain = drive.truth.drivetrain
    compliances = np.array([1.0 / shaft.stiffness for shaft in chain.shafts])
    rates = np.array([shaft.damping / shaft.stiffness for shaft in chain.shafts])
    gaps = np.array([shaft.backlash for shaft in chain.shafts])
    gap, parts = int(np.argmax(gaps if np.any(gaps) else compliances)), compliances / compliances.sum()
    # Inertias of either side and the shafts between them, from the end towards the gap.
    sides = {
        False: (chain.inertias[: gap + 1], range(gap)),
        True: (chain.inertias[:gap:-1], range(len(parts) - 1, gap, -1)),
    }
    values = {
        "inertia_motor": sum(sides[False][0]), "inertia_load": sum(sides[True][0]), "backlash": float(gaps[gap]),
        "damping": float(parts @ rates / compliances.sum()),
    }  # fmt: skip
    pole = 2.0 * np.pi * lm.rig.eigenfrequencies(chain)[1]
    values["stiffness"] = pole**2 / (1.0 / values["inertia_motor"] + 1.0 / values["inertia_load"])
    behind, left, rest = [False, False], {side: sum(inertias) for side, (inertias, _) in sides.items()}, 1.0
    further = [(side, k) for side, (inertias, _) in sides.items() for k in range(1, len(inertias))]
    for which, (side, k) in enumerate(further[:2]):
        inertias, shafts = sides[side]
        part, end, beyond = parts[shafts[k - 1]], ("", "_fourth")[which], sum(inertias[k:])
        values |= {f"share{end}": beyond / left[side], f"compliance{end}": part / rest}
        values[f"loss{end}"] = rates[shafts[k - 1]] / rates[gap] if rates[gap] else 1.0
        behind[which], left[side], rest = side, beyond, rest - part
    for end, friction in (("", chain.frictions[-1]), ("_motor", chain.frictions[0])):
        values |= {f"coulomb{end}": friction.coulomb_plus, f"viscous{end}": friction.viscous}
        if friction.stribeck and friction.coulomb_plus:
            values[f"rise{end}"] = friction.stribeck[0][1] / friction.coulomb_plus
            values[f"fade{end}"] = friction.stribeck[1][0] / np.log(2.0)
    # A measured torque is that which acts, later than it was commanded.
    whole = drive.truth.parameters["lag"] or 0.0
    values["lag"] = max(min(chain.actuator.lag, whole), LITTLE * dt)
    values["delay"] = whole - values["lag"]
    return values, behind[0], behind[1]


def from_the_true_chain(search: Search, drive: lm.rig.Drive) -> Candidate:
    """The lowest of descents from there under all laws."""
    values, third, fourth = true_values(drive, search.part.dt)
    own = {INDEX[name] for name in values if values[name] or name in FRICTIONS}
    free = sorted({*search.free, *own} - ({INDEX["backlash"]} if not values["backlash"] else set()))

    def begun() -> Iterator[Candidate]:
        for law, ramp in product(LAWS, (False, True)):
            flt = replace(search.part, law=law, ramp=ramp, behind=third, fourth_behind=fourth)
            theta = fitted_rates(flt, flt.changed(search.begun["nameplate"], **values))
            yield Candidate("true chain", theta, flt.run(theta).cost, flt, free)

    return min(search.polished(sorted(begun(), key=cost_of)[:2]), key=cost_of)


def main() -> None:
    parser = parser_of(__doc__ or "")
    parser.add_argument("set", choices=["development", "calibration"])
    parser.add_argument("--first", type=int, default=0, help="first drive of the set")
    parser.add_argument("--drives", type=int, default=20)
    args = parser.parse_args()
    seeds = lm.rig.SETS[args.set][args.first : args.first + args.drives]
    print(
        "| seed | masses | found: cost | true chain: cost | likelier by | found over true: inertias, stiffness, gap |"
    )
    print("|---" * 6 + "|")
    missed: dict[int, list[bool]] = {}
    for seed in seeds:
        try:
            drive = lm.rig.drive(seed)
        except LostMotionError:
            continue
        masses = len(drive.truth.drivetrain.inertias)
        result = searched(drive) if masses > 1 else None
        if result is None:
            continue
        search, found = result
        true, rows = from_the_true_chain(search, drive), found.flt.counting.size
        likelier, truth = (found.cost - true.cost) * rows, drive.truth.parameters
        ratios = [f"{found.values[name] / truth[name]:.3g}" if truth[name] else "–" for name in CORE]
        print(
            f"| {seed} | {masses} | {found.cost:.4f} | {true.cost:.4f} | {likelier:.0f} | {', '.join(ratios)} |",
            flush=True,
        )
        missed.setdefault(masses, []).append(likelier > CLEARLY)
    for masses, each in sorted(missed.items()):
        print(f"\n{masses} masses: the true chain is clearly likelier on {sum(each)} of {len(each)} drives.")


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
