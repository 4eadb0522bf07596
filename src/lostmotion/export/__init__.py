"""Export: a DiscreteSystem as code for the target."""

from .c import C_FLAGS, ExportCheck, c, compile_and_check

__all__ = ["C_FLAGS", "ExportCheck", "c", "compile_and_check"]
