"""Export: a DiscreteSystem as code for the target."""

from .c import ExportCheck, c, compile_and_check

__all__ = ["ExportCheck", "c", "compile_and_check"]
