"""Export: a DiscreteSystem, or a Stepper whose step has a C counterpart, as code for the target."""

from .c import ExportCheck, c, compile_and_check
from .compiler import C_FLAGS
from .shared_library import shared_library

__all__ = ["C_FLAGS", "ExportCheck", "c", "compile_and_check", "shared_library"]
