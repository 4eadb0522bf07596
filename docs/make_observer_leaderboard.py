"""The observers' leaderboard and all pages that quote it: python docs/make_observer_leaderboard.py FOLDER [RIGS]

Computes what is missing in the folder (``compare_observers``: by default 20 rigs, half an hour on two quiet cores; it
goes on where it was stopped), then writes the figure and the parts between ``<!-- … -->`` marks of the pages.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from datetime import date

from make_controller_leaderboard import DOCS, replaced

from lostmotion.compare import CASES, Leaderboard, compare_observers
from lostmotion.compare.leaderboard import RANKED_BY
from lostmotion.plot import leaderboard

OFF = tuple(case.name for case in CASES if case.factors)
FIRST, SECOND, ADAPTIVE = "Observer 1", "Observer 2", "extended Kalman"
BOTH = "extended Kalman, both sensors"

#: Situation, what to take, its row of the leaderboard, cases.
SITUATIONS = (
    ("identified, encoder of 14 bit or better", "Observer 1", FIRST, ("identified",)),
    ("identified, torque sensor", "Observer 2", SECOND, ("identified",)),
    ("any one parameter 20 % off", "`extended_kalman(…)`", ADAPTIVE, OFF),
    ("the same, with torque sensor", "`extended_kalman(…, measured=both)`", BOTH, OFF),
    ("unknown load torque of 3 Nm", "`extended_kalman(…)`", ADAPTIVE, ("load torque 3 Nm",)),
    ("the same, fixed gain", "`kalman(…, load_torque=True)`", "load torque", ("load torque 3 Nm",)),
    (
        "the same, fast load torque, fixed gain", "`h_infinity(…, load_torque=True)`", "H∞, load torque",
        ("load torque 3 Nm",),
    ),
    ("encoder of 10 bit", "`extended_kalman(…)`", ADAPTIVE, ("encoder 10 bit",)),
    ("the same, fixed gain", "`h_infinity(…)`", "H∞", ("encoder 10 bit",)),
    ("sample time of 2 ms", "`extended_kalman(…)`", ADAPTIVE, ("sample time 2 ms",)),
    ("load at rest half of the time", "`interacting_models(…)`", "interacting models", ("sticking",)),
    ("wrong side of the gap at the start", "`interacting_models(…)`", "interacting models", ("wrong start",)),
    ("any drive of two masses", "`interacting_models(…)`", "interacting models", ("any drive, two masses",)),
    ("the same, fixed gain", "`kalman(…, load_torque=True)`", "load torque", ("any drive, two masses",)),
    ("any drive with a wide gap", "Observer 1", FIRST, ("any drive, wide gap",)),
)  # fmt: skip
#: Rows and parameters of the table of shaft torques.
TOLD_WRONG = (
    FIRST, "load torque", "load torque, fast", "Observer 2, load torque", ADAPTIVE, BOTH,
)  # fmt: skip
WRONG = ("stiffness", "backlash", "inertia_motor")


def percent(board: Leaderboard, observer: str, cases: tuple[str, ...], metric: str = RANKED_BY) -> str:
    """The largest median of the cases."""
    return f"{100.0 * max(_value(board, observer, case, metric) for case in cases):.2g}"


def situations(board: Leaderboard) -> str:
    rows = ["| situation | take | error | Observer 1 |", "|---|---|---|---|"]
    for words, take, observer, cases in SITUATIONS:
        rows.append(
            f"| {words} | {take} | {percent(board, observer, cases)} | {percent(board, FIRST, cases)} |"
        )
    return "\n".join(rows)


def shaft_torques(board: Leaderboard) -> str:
    heads = [f"{name} − / +".replace("inertia_motor", "motor inertia") for name in WRONG]
    rows = [
        f"| shaft torque %, 20 % off | {' | '.join(heads)} | load speed %, worst of sixteen |",
        "|---" * (len(WRONG) + 2) + "|",
    ]
    for observer in TOLD_WRONG:
        cells = [
            " / ".join(percent(board, observer, (f"{name} {sign}20 %",), "torque_shaft") for sign in "−+")
            for name in WRONG
        ]
        rows.append(f"| {observer} | {' | '.join(cells)} | {percent(board, observer, OFF)} |")
    return "\n".join(rows)


def targets(board: Leaderboard) -> str:
    rows = [
        ("Observer 1 after identification, load speed %", "≤ 0.2", FIRST, "identified", "speed_load"),
        ("the same, shaft torque %", "≤ 1.5", FIRST, "identified", "torque_shaft"),
        ("the same, F1 of the gap", "≥ 0.9", FIRST, "identified", "f1_gap"),
    ]
    best = max(board.entries, key=lambda n: _value(board, n, "identified", "f1_gap"))
    rows.append((f"best F1 after identification: {best}", "≥ 0.95", best, "identified", "f1_gap"))
    for name in ("load torque", "Observer 2, load torque"):
        for metric, words in (("speed_load", "load speed"), ("torque_shaft", "shaft torque")):
            worst = max(OFF, key=lambda case: _value(board, name, case, metric))
            text = f"{name}, one parameter off by 20 %: worst {words} % ({worst})"
            rows.append((text, "≤ 2.5", name, worst, metric))
    lines = [f"| {len(board.seeds)} rigs, median (95 %) | target | found |", "|---|---|---|"]
    for words, limit, name, case, metric in rows:
        found, scale = board.median(name, case, metric), 1.0 if metric == "f1_gap" else 100.0
        assert found is not None
        numbers = [f"{scale * v:.3g}" for v in (found.value, found.low, found.high)]
        lines.append(f"| {words} | {limit} | {numbers[0]} ({numbers[1]} to {numbers[2]}) |")
    return "\n".join(lines)


def _value(board: Leaderboard, observer: str, case: str, metric: str) -> float:
    found = board.median(observer, case, metric)
    return 0.0 if found is None else found.value


def whole(board: Leaderboard) -> str:
    return f"{_head(board)}\n\n{board.to_markdown().strip()}"


def ranking(board: Leaderboard) -> str:
    return f"{_head(board)}\n\n{board.ranking_table()}"


def _head(board: Leaderboard) -> str:
    return f"{len(board.cases)} cases, seeds {board.seeds[0]} to {board.seeds[-1]}, {date.today():%Y-%m-%d}."


#: Page, mark, what stands there.
PARTS: tuple[tuple[str, str, Callable[[Leaderboard], str]], ...] = (
    ("leaderboard.md", "ranking", ranking),
    ("leaderboard.md", "any drive", Leaderboard.zoo_table),
    ("choosing-an-observer.md", "situations", situations),
    ("benchmarks/observers.md", "tables", whole),
    ("benchmarks/observers.md", "targets", targets),
    ("benchmarks/observers.md", "shaft torques", shaft_torques),
)


def main() -> None:
    board = compare_observers(
        sys.argv[1],
        seeds=int(sys.argv[2]) if len(sys.argv) > 2 else None,
        progress=lambda done, text: print(f"{100.0 * done:5.1f} %  {text}", flush=True),
    )
    for name, mark, made in PARTS:
        page = DOCS / name
        page.write_text(replaced(page.read_text(), mark, made(board)))
    leaderboard(board.to_dict()).savefig(DOCS / "images" / "leaderboard.png", dpi=95, facecolor="white")


if __name__ == "__main__":
    main()
