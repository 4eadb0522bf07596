"""Identification on the zoo of drives: coverage, gross errors, share identified, errors and time per dimension.

    python benchmarks/zoo.py development --drives 80 --results zoo.jsonl      # goes on where it stopped
    python benchmarks/zoo.py development --results zoo.jsonl --picture zoo.png --summary zoo.json
    python benchmarks/zoo.py test --results benchmarks/results/zoo-test.jsonl.gz     # the tables of the docs

Every drive's result is one line of the results file; tables are made of all lines whose seed is in the set. The sets
are those of ``lostmotion.rig.SETS``; the test set is run once for each change of rules.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from shared import parser_of, read
from zoo_gap_bound import gap_bound
from zoo_observer import observer_errors
from zoo_shares import share_table
from zoo_tables import Scores, picture, summary, tables
from zoo_targets import target_lines, target_table

import lostmotion as lm
from lostmotion.errors import InvalidInput, LostMotionError
from lostmotion.identification.prediction_error.innovations import Predictor
from lostmotion.identification.prediction_error.slow_motion.total_inertia import known, of_slow_motion


def identified(seed: int, longest: int, second: bool, total: bool) -> dict[str, Any] | None:
    """What ``identify`` finds of one drive, beside its truth; None if the recording has more than ``longest`` rows, or
    the seed has no drive that keeps its speed.

    ``total``: only the total inertia of the slow motion.
    """
    try:
        drive = lm.rig.drive(seed)
    except InvalidInput as none:
        print(none, flush=True)
        return None
    if len(drive.recording) > longest:
        return None
    judged = {name: value for name, value in drive.truth.parameters.items() if value is not None}
    entry: dict[str, Any] = {
        "seed": seed,
        "dimensions": dict(drive.dimensions),
        "truth": judged,
        "absent": drive.absent,
        "nameplate": drive.nameplate.parameters(),
        "bound": lm.rig.cramer_rao(drive),
        "found": {},
    }
    before = time.perf_counter()
    if total:
        entry["found"] = slow_motion(drive)
        entry["time"] = time.perf_counter() - before
        return entry
    try:
        found = lm.identify(drive.recording, start=drive.nameplate, second_estimator=second)
    except LostMotionError as refusal:
        found = None
        entry["refusal"] = str(refusal)[:300]
    entry["time"] = time.perf_counter() - before
    if found is not None:
        entry["found"] = {
            name: {"value": found.values[name], "interval": list(found.intervals[name])}
            for name, source in found.sources.items()
            if source == "identified"
        }
        entry["fit"] = found.prediction.fit
        entry["problems"] = [problem.where for problem in found.problems]
        entry["observer"] = observer_errors(drive, found)
        entry["gap_bound"] = gap_bound(found)
    return entry


def slow_motion(drive: lm.rig.Drive) -> dict[str, Any]:
    """What ``identify`` takes where nothing else tells the total inertia, or tells it as well."""
    recording, start = drive.recording, drive.nameplate
    signals = (recording["torque_motor"], recording["speed_motor"], recording.dt)
    predictor = Predictor(
        *signals, recording.meta["speed_from_counts"], start, skip=0, bounds=(0, len(recording))
    )
    found = known(*of_slow_motion(predictor, start.zero_frequency))
    return {} if found is None else {"inertia_total": {"value": found[0], "interval": list(found[1])}}


def run(seeds: Iterable[int], results: Path, processes: int, longest: int, second: bool, total: bool) -> None:
    """Identifies the drives that the results file does not have yet, and appends a line for each."""
    one = partial(identified, longest=longest, second=second, total=total)
    done = {entry["seed"] for entry in read(results)}
    todo = [seed for seed in seeds if seed not in done]
    if not todo:
        return
    with results.open("a") as file, ProcessPoolExecutor(processes) as pool:
        for number, entry in enumerate(pool.map(one, todo), 1):
            if entry is None:
                continue
            file.write(json.dumps(entry) + "\n")
            file.flush()
            print(f"{number} of {len(todo)}: seed {entry['seed']}, {entry['time']:.1f} s", flush=True)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("set", choices=list(lm.rig.SETS))
    parser.add_argument("--drives", type=int, default=0, help="the first so many of the set; 0: tables alone")
    parser.add_argument("--first", type=int, default=0, help="first of them")
    parser.add_argument("--results", type=Path, required=True, help="a line of JSON for each drive")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--longest", type=int, default=250_000, help="longer recordings are left out, rows")
    parser.add_argument("--fit-alone", action="store_true", help="without the second estimator")
    parser.add_argument("--total-alone", action="store_true", help="only the slow motion's total inertia")
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--summary", type=Path, help="the pooled numbers as JSON")
    arguments = parser.parse_args()
    if arguments.results.suffix == ".gz" and arguments.drives:
        parser.error(f"{arguments.results} is packed: unpack it to add drives to it")
    seeds = lm.rig.SETS[arguments.set]
    run(
        seeds[arguments.first : arguments.first + arguments.drives],
        arguments.results,
        arguments.processes,
        arguments.longest,
        not arguments.fit_alone,
        arguments.total_alone,
    )
    scores = Scores([entry for entry in read(arguments.results) if entry["seed"] in seeds])
    print(tables(scores))
    if scores.entries:
        print("", *share_table(scores), "", *target_table(target_lines(scores)), sep="\n")
    if arguments.summary:
        arguments.summary.write_text(json.dumps(summary(scores), indent=1))
    if arguments.picture:
        picture(scores, arguments.picture)


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
