"""Compiles the kernels and puts them into the wheel, for the processor and the Python that build it.

``pip install .`` so has the first run without compiling. Without numba, or with LOSTMOTION_KERNELS=none in the
environment, the wheel has none: it is for every machine, and kernels are compiled where they are first used.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

#: Compiled at the same time, a process each: three on two processors end at about the same time.
PARTS = (("simulation",), ("identification",), ("observers",))
#: numba's own files, an index and a compiled function each, and our mark of a part that is complete.
COMPILED = ("*.nbi", "*.nbc", "compiled-*")


class CompiledKernels(BuildHookInterface):
    """Hatchling's hook: adds files to a wheel before it is built."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile in a copy of the sources and force the files into the wheel."""
        if version == "editable" or os.environ.get("LOSTMOTION_KERNELS") == "none":
            return
        self._copy = tempfile.TemporaryDirectory(prefix="lostmotion-build-")
        package = Path(self._copy.name) / "lostmotion"
        shutil.copytree(
            Path(self.root) / "src" / "lostmotion", package, ignore=shutil.ignore_patterns("__pycache__")
        )
        if not _compile(package):
            self.app.display_warning("kernels are not compiled by this build, but where they are first used")
            return
        for pattern in COMPILED:
            for file in (package / "kernels").rglob(pattern):
                build_data["force_include"][str(file)] = f"lostmotion/{file.relative_to(package).as_posix()}"
        build_data["pure_python"] = False
        build_data["infer_tag"] = True

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the copy."""
        if hasattr(self, "_copy"):
            self._copy.cleanup()


def _compile(package: Path) -> bool:
    """Compile all kernels of a copy of the package beside their sources; whether it worked."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
    paths = [str(package.parent), *filter(None, [environment.get("PYTHONPATH")])]
    environment["PYTHONPATH"] = os.pathsep.join(paths)
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "lostmotion.precompile", *parts],
            env=environment, cwd=package.parent, stdout=subprocess.DEVNULL,
        )
        for parts in PARTS
    ]  # fmt: skip
    return all([child.wait() == 0 for child in started])
