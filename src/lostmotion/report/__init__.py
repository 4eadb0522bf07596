"""The report: one self-contained HTML page from the results of a run."""

from __future__ import annotations

from .images import ReportFigure
from .page import render, write_report

__all__ = ["ReportFigure", "render", "write_report"]
