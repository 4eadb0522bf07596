"""shared_library: the exported C of a law, compiled, to be called from another program."""

from __future__ import annotations

from pathlib import Path

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from ..systems import DiscreteSystem, Stepper
from .c import c
from .compiler import C_FLAGS, NO_COMPILER, find_compiler, run

#: Whoever calls the library cannot know how large the law's memory is.
_SIZE = """#include "law.h"
unsigned long law_size(void);
unsigned long law_size(void) { return sizeof(law_state); }
"""


@checks_arguments
def shared_library(law: DiscreteSystem | Stepper, folder: str | Path) -> Path:
    """Write the law as C into a folder and compile it there: law.so with ``law_init``, ``law_step``, ``law_size``.

    Raises
    ------
    InvalidInput
        If there is no C compiler, it fails, or ``export.c`` refuses the law.
    """
    folder = Path(folder)
    compiler = find_compiler()
    if compiler is None:
        raise InvalidInput(
            "export.shared_library", NO_COMPILER, "a C compiler", "Install one, or run the Python law."
        )
    c(law, folder, vectors=2)
    (folder / "law_size.c").write_text(_SIZE)
    library, sources = folder / "law.so", [str(folder / "law.c"), str(folder / "law_size.c")]
    built = run([compiler, *C_FLAGS, "-shared", "-fPIC", "-o", str(library), *sources])
    if built.returncode != 0:
        raise InvalidInput(
            "export.shared_library", f"does not compile: {built.stderr.strip()}", "a law that compiles",
            "Set CC to a C99 compiler.",
        )  # fmt: skip
    return library
