"""Ctrl-C and SIGTERM at any moment: no traceback, the shell's exit codes, nothing hidden left, no work lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from lostmotion.interruption import as_exceptions

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals as on POSIX systems")


def started(*arguments: str, cwd: Path, verbose: bool = False) -> subprocess.Popen[str]:
    """The command; with ``verbose`` Python names every module on standard error as it is imported."""
    options = ["-X", "importtime"] if verbose else []
    command = [sys.executable, *options, "-m", "lostmotion", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd)


def read_until(process: subprocess.Popen[str], word: str) -> None:
    assert process.stderr is not None
    for line in process.stderr:
        if word in line:
            return
    pytest.fail(f"{word} never came")


@pytest.mark.parametrize(
    ("command", "module"),
    [
        (("run",), "typer.colors"),
        (("run",), "click"),
        (("run",), "numpy"),
        (("simulate", "x.toml"), "numpy"),
        (("check", "x.toml"), "pydantic"),
        (("identify",), "scipy"),
        (("compare", "observers"), "rich.console"),
    ],
)
def test_ctrl_c_during_the_imports_is_one_line(tmp_path: Path, command: tuple[str, ...], module: str) -> None:
    with started(*command, cwd=tmp_path, verbose=True) as process:
        read_until(process, module)
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=60)[1]
    said = [line for line in rest.splitlines() if not line.startswith("import time:")]
    assert process.returncode == 130, rest[-500:]
    assert len(said) == 1 and said[0].startswith("Interrupted")
    assert list(tmp_path.iterdir()) == []


def test_little_is_imported_before_an_interruption_is_one_line() -> None:
    """What comes before the command's first line is the time in which Python answers with a traceback of its own."""
    command = (
        "import sys; before = set(sys.modules); import lostmotion.__main__; print(*set(sys.modules) - before)"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    own = {name for name in done.stdout.split() if name.startswith("lostmotion")}
    assert own == {"lostmotion", "lostmotion.version", "lostmotion.__main__"}
    assert not {"typing", "re", "contextlib", "importlib.util", "threading"} & set(done.stdout.split())


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_what_was_begun_is_put_away(tmp_path: Path, number: signal.Signals) -> None:
    with started("run", "--out", "out", cwd=tmp_path) as process:
        read_until(process, "identify")
        assert [path.name[:8] for path in tmp_path.iterdir()] == [".out.new"]
        process.send_signal(number)
        rest = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + number, rest
    assert "Traceback" not in rest
    assert list(tmp_path.iterdir()) == []


def test_what_is_ignored_stays_ignored() -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with as_exceptions():
            os.kill(os.getpid(), signal.SIGTERM)
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before)


def test_handlers_are_put_back_and_other_threads_have_none() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(SystemExit) as caught, as_exceptions():
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(5.0)
    assert caught.value.code == 128 + signal.SIGTERM
    assert signal.getsignal(signal.SIGTERM) is before
    seen = []

    def inside() -> None:
        with as_exceptions():
            seen.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=inside)
    thread.start()
    thread.join()
    assert seen == [before]


@pytest.mark.parametrize(
    ("number", "expected"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)]
)
def test_what_another_package_makes_of_an_interruption_is_one(
    number: signal.Signals, expected: type[BaseException]
) -> None:
    """numba, interrupted while it compiles, ends with an error of its own."""
    with pytest.raises(expected), as_exceptions():
        try:
            os.kill(os.getpid(), number)
            time.sleep(5.0)
        except BaseException:
            raise RuntimeError("no compiled object yet") from None


@pytest.mark.parametrize(
    ("number", "expected"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)]
)
def test_what_another_package_swallows_is_raised_where_the_block_ends(
    number: signal.Signals, expected: type[BaseException]
) -> None:
    with pytest.raises(expected), as_exceptions():
        try:
            os.kill(os.getpid(), number)
            time.sleep(5.0)
        except BaseException:
            pass


@pytest.mark.parametrize(
    ("number", "expected"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)]
)
def test_an_import_that_would_swallow_an_interruption_is_done_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals, expected: type[BaseException]
) -> None:
    text = f"import os, time\ntry:\n    os.kill(os.getpid(), {int(number)}); time.sleep(0.2)\n"
    (tmp_path / "swallows_any.py").write_text(text + "except BaseException:\n    pass\nfinished = True\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "swallows_any", raising=False)
    began = time.monotonic()
    with pytest.raises(expected), as_exceptions():
        import swallows_any  # type: ignore[import-not-found]

        assert swallows_any.finished
        time.sleep(5.0)
    assert time.monotonic() - began < 4.0


def test_llvm_is_left_before_an_interruption(tmp_path: Path) -> None:
    """Python would report and forget what is raised in its callbacks; memory that it took over would be freed twice."""
    (tmp_path / "llvmlite").mkdir()
    path = tmp_path / "llvmlite" / "binding.py"
    text = "def call():\n    os.kill(os.getpid(), signal.SIGINT); time.sleep(0.2)\n    return True\n"
    names = {"os": os, "signal": signal, "time": time}
    exec(compile(text, path, "exec"), names)
    left = False
    with pytest.raises(KeyboardInterrupt), as_exceptions():
        left = names["call"]()  # type: ignore[operator]
        time.sleep(5.0)
    assert left


def test_an_error_that_no_signal_caused_stays_one() -> None:
    with pytest.raises(RuntimeError), as_exceptions():
        raise RuntimeError("a defect")


def test_a_forked_worker_ends_at_once() -> None:
    with as_exceptions():
        process = os.fork()
        if process == 0:
            time.sleep(20.0)
            os._exit(0)
        time.sleep(0.2)
        os.kill(process, signal.SIGTERM)
        assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == -signal.SIGTERM
