"""The build puts compiled kernels into the wheel, and makes one without them where it cannot compile."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def build() -> ModuleType:
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_hook(build: ModuleType, version: str = "standard") -> tuple[dict[str, Any], list[str]]:
    warnings: list[str] = []
    hook = build.CompiledKernels.__new__(build.CompiledKernels)
    hook._BuildHookInterface__root = str(ROOT)
    hook._BuildHookInterface__app = SimpleNamespace(display_warning=warnings.append)
    data: dict[str, Any] = {"force_include": {}}
    hook.initialize(version, data)
    data["existed"] = [Path(file).exists() for file in data["force_include"]]
    hook.finalize(version, data, "")
    return data, warnings


def compile_one(package: Path) -> bool:
    """In the place of a minute of compiling."""
    assert (package / "kernels" / "plant" / "layout.py").exists()
    for name in ("one.nbi", "one.1.nbc", "compiled-simulation.cpython"):
        cache = package / "kernels" / "plant" / "__pycache__"
        cache.mkdir(exist_ok=True)
        (cache / name).write_text("")
    return True


def test_compiled_kernels_go_into_the_wheel(build: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("LOSTMOTION_KERNELS", raising=False)
    monkeypatch.setattr(build, "_compile", compile_one)
    data, warnings = run_hook(build)
    cache = "lostmotion/kernels/plant/__pycache__"
    assert set(data["force_include"].values()) == {
        f"{cache}/one.nbi", f"{cache}/one.1.nbc", f"{cache}/compiled-simulation.cpython",
    }  # fmt: skip
    assert all(data["existed"]) and not warnings
    assert data["infer_tag"] and not data["pure_python"]
    assert not any(Path(file).exists() for file in data["force_include"])


def test_where_it_fails_the_wheel_is_for_every_machine(
    build: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("LOSTMOTION_KERNELS", raising=False)
    monkeypatch.setattr(build, "_compile", lambda package: False)
    data, warnings = run_hook(build)
    assert not data["force_include"] and "pure_python" not in data and len(warnings) == 1


@pytest.mark.parametrize(("version", "variable"), [("editable", ""), ("standard", "none")])
def test_none_are_compiled_where_none_are_wanted(
    build: ModuleType, monkeypatch: pytest.MonkeyPatch, version: str, variable: str
) -> None:
    monkeypatch.setenv("LOSTMOTION_KERNELS", variable)
    monkeypatch.setattr(build, "_compile", lambda package: pytest.fail("compiled"))
    assert run_hook(build, version)[0]["force_include"] == {}


def test_every_part_is_compiled(build: ModuleType) -> None:
    from lostmotion.precompile import PARTS

    assert sorted(part for group in build.PARTS for part in group) == sorted(PARTS)
