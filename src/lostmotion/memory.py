"""How much memory a file or a command may take: what it needs is known, and said, before it is taken."""

from __future__ import annotations

import os
import re

from .errors import InvalidInput

#: The environment variable that raises the limit, as ``lostmotion --memory-limit`` does.
VARIABLE = "LOSTMOTION_MEMORY_LIMIT"
#: Bytes that reading one file, or one simulation, may take (option: five channels at 10 kHz for five minutes as CSV).
DEFAULT = 1e9
#: More than this, bytes, no limit is offered for (option: no desk has it).
LARGEST = 1e12

#: Bytes; a number alone is GB (option).
_UNITS = {"": 1e9, "GB": 1e9, "MB": 1e6}
_SIZE = re.compile(r"\s*(\d+\.?\d*)\s*(GB|MB|)\s*", re.IGNORECASE | re.ASCII)


def memory_limit() -> float:
    """Bytes; raises ``InvalidInput`` where the environment says what is no size."""
    return parse_size(os.environ.get(VARIABLE) or f"{DEFAULT / 1e9:g}", VARIABLE)


def parse_size(text: str, where: str) -> float:
    """``"4 GB"``, ``"500 MB"``, ``"4"`` (GB) in bytes."""
    match = _SIZE.fullmatch(text)
    if match is None or not float(match[1]) > 0.0:
        raise InvalidInput(
            where, repr(text), 'a size such as "4GB" or "500MB"', "Leave it out for the default."
        )
    return float(match[1]) * _UNITS[match[2].upper()]


def size_text(size: float) -> str:
    """``2.4 GB``, ``730 MB``."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{max(size / 1e6, 0.1):.3g} MB"


def check_memory(where: str, got: str, needed: float, remedy: str) -> None:
    """Raises ``InvalidInput`` where so many bytes are more than the limit; ``got`` says what takes them."""
    limit = memory_limit()
    if needed > limit:
        raise too_much(where, f"{got}, for which {size_text(needed)} of memory are needed", needed, remedy)


def too_much(where: str, got: str, needed: float, remedy: str) -> InvalidInput:
    """The error that says how the limit is raised to what is needed (bytes), where a machine can have that."""
    if needed < LARGEST:
        size = _enough(needed)
        remedy += (
            f" Or raise the limit: lostmotion --memory-limit {size} before the command's name, or "
            f"{VARIABLE}={size} in the environment."
        )
    return InvalidInput(where, got, f"what takes at most {size_text(memory_limit())} of memory", remedy)


def _enough(needed: float) -> str:
    """The next limit of two digits."""
    step = 10.0 ** max(len(str(int(needed / 1e6))) - 2, 0)
    size = -(-needed / 1e6 // step) * step
    return f"{size / 1e3:g}GB" if size >= 1e3 else f"{size:g}MB"
