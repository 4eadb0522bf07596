"""python -m lostmotion, and the command lostmotion."""

import os
import signal


def main() -> None:
    _exit_at_once()  # before the imports, which take a third of a second
    from .child_process import use_one_blas_thread

    use_one_blas_thread()  # before the commands: BLAS asks once, when numpy is imported
    from .cli import main as run_command

    run_command()


def _exit_at_once() -> None:
    """From now on Ctrl-C ends the process without a word of Python's: for what only imports and reads.

    An exception would have to find its way through other packages' imports, some of which swallow any.
    """
    # Not where the shell lets it be ignored.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _exit)


def _exit(number: int, frame: object) -> None:
    try:  # noqa: SIM105 (contextlib would have to be imported first)
        os.write(2, b"Interrupted; nothing was written.\n")
    except OSError:
        pass
    os._exit(128 + number)  # as shells have it


if __name__ == "__main__":
    main()
