"""Damaged files by the hundred thousand: what every reader makes of them.

    python benchmarks/fuzz.py --count 100000            # 7 min on one core
    python benchmarks/fuzz.py --format MAT --first 500 --count 1 --keep there     # one of them, kept

Prints a Markdown table: per format how many files did anything but be read or raise the package's own error within
5 s and 1 GB, then what they did and the number of the first that did it. Each format runs in a process of its own, so
that a crash is counted and the next file goes on. POSIX only.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "fuzz"))

from fuzz_formats import FORMATS, Format
from fuzz_limits import fault

#: After so many seconds without a word a process hangs where no alarm reaches it.
HANGS = 100.0


def work(kind: Format, first: int, stop: int, folder: Path) -> None:
    """Read the mutations in turn; a line for each: its number before, what it did behind."""
    path = folder / kind.file_name
    for number in range(first, stop):
        data = kind.mutation(number)
        path.write_bytes(data)
        print(number, end=" ", flush=True)
        print(fault(lambda: kind.read(path)), flush=True)


def faults(kind: Format, first: int, stop: int) -> dict[int, str]:
    """What mutations did, by number; those that were read or refused are left out."""
    found: dict[int, str] = {}
    while first < stop:
        command = [
            sys.executable,
            __file__,
            "--format",
            kind.name,
            "--first",
            str(first),
            "--work",
            str(stop),
        ]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ) as process:
            assert process.stdout is not None
            reached, hung = first - 1, False

            def kill(process: subprocess.Popen[str] = process) -> None:
                nonlocal hung
                hung = True
                process.kill()

            timer = threading.Timer(2.0 * HANGS, kill)  # the first one waits for imports
            timer.start()
            for line in process.stdout:
                timer.cancel()
                timer = threading.Timer(HANGS, kill)
                timer.start()
                number, _, what = line.rstrip("\n").partition(" ")
                reached = int(number)
                if what:
                    found[reached] = what
            timer.cancel()
        if process.returncode == 0:
            return found
        # The last line has no answer: the file that it names ended the process.
        if hung:
            found[reached] = "hangs"
        else:
            found[reached] = f"ends the process (signal {-process.returncode})"
        if reached < first:
            raise RuntimeError(f"{kind.name}: no mutation could be made")
        first = reached + 1
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000, help="files in all")
    parser.add_argument("--first", type=int, default=0, help="number of the first in each format")
    parser.add_argument("--format", help="one format alone")
    parser.add_argument("--keep", type=Path, help="folder for the first file of every kind of fault")
    parser.add_argument("--work", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    kinds = [kind for kind in FORMATS if options.format in (None, kind.name)]
    if options.work is not None:
        with tempfile.TemporaryDirectory() as folder:
            work(kinds[0], options.first, options.work, Path(folder))
        return
    each = -(-options.count // len(kinds))
    print("| format | files | faults |\n|---|---|---|", flush=True)
    lines = []
    for kind in kinds:
        found = faults(kind, options.first, options.first + each)
        print(f"| {kind.name} | {each} | {len(found)} |", flush=True)
        for what, count in Counter(found.values()).most_common():
            number = min(n for n, fault_ in found.items() if fault_ == what)
            lines.append(f"{kind.name}: {count} × {what}, first {number}")
            if options.keep is not None:
                options.keep.mkdir(parents=True, exist_ok=True)
                (options.keep / f"{number}-{kind.file_name}").write_bytes(kind.mutation(number))
    print("\n" + "\n".join(lines))


if __name__ == "__main__":
    main()
