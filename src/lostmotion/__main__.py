"""python -m lostmotion, and the command lostmotion."""

from .interruption import exit_at_once


def main() -> None:
    exit_at_once()  # before the imports, which take a third of a second
    from .cli import main as run_command

    run_command()


if __name__ == "__main__":
    main()
