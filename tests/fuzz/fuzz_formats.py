"""Every format that the package reads: sound examples, their damaged forms, and the reader."""

from __future__ import annotations

import functools
import hashlib
import io
import json
import random
import tempfile
import tomllib
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fuzz_bytes
import fuzz_tables
import fuzz_trees
import numpy as np

import lostmotion as lm
from lostmotion import io as files

Rewrite = Callable[[bytes, random.Random], bytes]


@dataclass(frozen=True)
class Format:
    """One format.

    Parameters
    ----------
    name : str
    file_name : str
        Under which the reader finds it.
    examples : function → tuple of bytes
        Sound files.
    restructured : (bytes, random) → bytes
        An example with another structure.
    read : (path) → object
    """

    name: str
    file_name: str
    examples: Callable[[], tuple[bytes, ...]]
    restructured: Rewrite
    read: Callable[[Path], object]

    def mutation(self, number: int) -> bytes:
        """The same bytes for the same number; odd numbers are damaged as bytes, even ones as structures."""
        rng = random.Random(zlib.crc32(self.name.encode()) + 1_000_003 * number)
        example = rng.choice(self.examples())
        if number % 2:
            return fuzz_bytes.damaged(example, rng)
        return self.restructured(example, rng)


def _saved(save: Callable[[Path], object]) -> bytes:
    """The bytes that a function writes to a path."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "file"
        save(path)
        return next(Path(folder).iterdir()).read_bytes()


@functools.cache
def _plant() -> lm.Drivetrain:
    return lm.Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
        viscous=0.0175,
    )  # fmt: skip


def _json_rewritten(data: bytes, rng: random.Random) -> bytes:
    return fuzz_trees.json_text(fuzz_trees.changed(json.loads(data), rng))


def _law_rewritten(data: bytes, rng: random.Random) -> bytes:
    """With another structure under a hash that fits it, or of before there were hashes."""
    content = json.loads(data)
    content.pop("sha256", None)
    content = fuzz_trees.changed(content, rng)
    if isinstance(content, dict) and rng.random() < 0.9:
        if rng.random() < 0.5:
            content["schema_version"] = 1
        else:
            signed = {k: v for k, v in content.items() if k not in ("kind", "schema_version")}
            text = json.dumps(signed, sort_keys=True, separators=(",", ":"), default=str)
            content["sha256"] = hashlib.sha256(text.encode(errors="backslashreplace")).hexdigest()
    return fuzz_trees.json_text(content)


def _toml_rewritten(data: bytes, rng: random.Random) -> bytes:
    text = fuzz_trees.toml_text(fuzz_trees.changed(tomllib.loads(data.decode()), rng))
    return text + b"# end\n" * rng.choice((0, 1))


@functools.cache
def laws() -> tuple[bytes, ...]:
    observer = lm.observers.kalman(_plant(), measured=("speed_motor",), dt=1e-4)
    controller = lm.controllers.pole_placement(_plant(), dt=1e-4, torque_limit=73.5)
    joined = lm.connect(
        [observer, controller], inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",)
    )
    speed = lm.controllers.pi(dt=1e-3, torque_limit=5.0)
    return tuple(
        _saved(functools.partial(lm.save_law, law)) for law in (joined, observer.without_checks(), speed)
    )


@functools.cache
def steppers() -> tuple[bytes, ...]:
    made = [
        lm.observers.extended_kalman(_plant(), dt=1e-4),
        lm.observers.sliding_mode(_plant(), dt=1e-4),
    ]
    return tuple(_saved(functools.partial(lm.save_law, stepper)) for stepper in made)


ROWS = 300
TIME = 1e-3 * np.arange(ROWS)
SPEED, TORQUE = 50.0 * np.sin(40.0 * TIME), 3.0 * np.cos(40.0 * TIME) + 0.01 * np.sin(977.0 * TIME)


@functools.cache
def recordings() -> tuple[bytes, ...]:
    measured = lm.Recording(
        TIME,
        {"speed_motor": SPEED, "torque_motor": TORQUE},
        {"speed_motor": "measured"},
        (lm.Event(0.1, "impact", "shaft 1", 0.5, 0.02),),
        {"state": np.array([0.0, 1.0]), "torque_motor": 1.5},
        {"seed": 3, "problems": (lm.Problem("warning", "a", "b", "c", "d"),), "speed_from_counts": True},
    )
    bare = lm.Recording(TIME, {"speed_motor": SPEED})
    return tuple(_saved(functools.partial(lm.save_recording, one)) for one in (measured, bare))


def _columns(separator: str, comma: bool, head: str) -> bytes:
    rows = [separator.join(f"{v:.7g}" for v in row) for row in zip(TIME, SPEED, TORQUE, strict=True)]
    text = "\n".join(rows)
    return (head + (text.replace(".", ",") if comma else text) + "\n").encode()


@functools.cache
def csv_tables() -> tuple[bytes, ...]:
    return (
        _columns(",", False, "time [s],speed_motor [rpm],torque_motor [Nm]\n"),
        _columns(";", True, "# logger\ntime;speed_motor;torque_motor\ns;1/min;Nm\n"),
        _columns("\t", False, '"time"\t"speed_motor"\t"torque_motor"\n'),
        _columns(",", False, ""),
    )


def _read_csv(path: Path) -> object:
    bare = not path.read_bytes()[:200].lstrip(b"\xef\xbb\xbf\xff\xfe\0").startswith((b"t", b"#", b'"'))
    channels = {"speed_motor": {"column": 1, "unit": "rpm"}, "torque_motor": {"column": 2}}
    return files.read_recording(path, time=0, channels=channels) if bare else files.read_recording(path)


@functools.cache
def mat_files() -> tuple[bytes, ...]:
    from scipy.io import savemat

    matrix = {"data": np.column_stack([TIME, SPEED, TORQUE]), "t": TIME, "note": "rig 7"}
    structure = {
        "out": {
            "time": TIME[:, None],
            "signals": [
                {"values": SPEED[:, None], "label": "speed_motor"},
                {"values": TORQUE[:, None], "label": "torque_motor [Nm]"},
            ],
        },
        "data": np.column_stack([TIME, SPEED, TORQUE]).astype(np.float32),
    }
    made = []
    for variables, arguments in (
        (matrix, {"do_compression": False}),
        (matrix, {"do_compression": True}),
        ({k: matrix[k] for k in ("data", "t")}, {"format": "4"}),
        (structure, {"do_compression": True}),
    ):
        out = io.BytesIO()
        savemat(out, variables, **arguments)
        made.append(out.getvalue())
    return tuple(made)


def _read_mat(path: Path) -> object:
    channels = {"speed_motor": "data[:,1]", "torque_motor": {"column": "data[:,2]", "unit": "Nm"}}
    return files.read_recording(path, time="data[:,0]", channels=channels)


CONFIGURATION = """
[nameplate]
inertia_motor = "180 kgcm2"
inertia_load = 0.1
stiffness = 6000
backlash = "0.7 deg"
[[recording]]
file = "rig.csv"
time = { column = 0, unit = "s" }
window = [0.0, 0.25]
channels.speed_motor = { column = 1, unit = "rpm" }
channels.torque_motor = { column = "Iq [A]", scale = 1.9, unit = "Nm", sign = -1 }
[[recording]]
file = "step.csv"
use = "validate"
resample = true
speed_from_counts = false
time = { sample_time = "0.1 ms" }
channels.angle_motor = { column = 3, unit = "counts", counts_per_rev = 4096, offset = 0 }
[law]
torque_limit = 73.5
poles = [-400, -400, -400]
kp = 10
ki = 200
[run]
seed = 1
"""


@functools.cache
def configurations() -> tuple[bytes, ...]:
    return CONFIGURATION.encode(), files.template().encode()


@functools.cache
def drivetrains() -> tuple[bytes, ...]:
    chain = lm.Drivetrain(
        (0.01, 0.02, 0.1),
        (lm.Shaft(5e3, 0.3, 0.01), lm.Shaft(9e3, 0.2, 0.0, "physical")),
        (lm.Friction(), lm.Friction((0.5, 0.6), 0.01), lm.Friction(1.0, 0.0, 2.0, ((0.0, 0.5), (0.2, 0.0)))),
        lm.Actuator(3e-4, 40.0),
    )
    return tuple(_saved(functools.partial(lm.save_drivetrain, one)) for one in (_plant(), chain))


@functools.cache
def results() -> tuple[bytes, ...]:
    content = {
        "seed": 1,
        "parameters": {
            "backlash": {"value": 0.012, "low": 0.011, "high": 0.013, "unit": "rad", "source": "identified"}
        },
        "problems": [],
    }
    return (_saved(lambda path: files.save_json(path, "results", content)),)


@functools.cache
def manifests() -> tuple[bytes, ...]:
    listed = {"run": {"report.html": "0" * 64, "c/law.c": "1" * 64}, "files": {"box.json": "2" * 64}}
    return (_saved(lambda path: files.save_json(path, "written_files", listed)),)


@functools.cache
def _model() -> Any:
    mass = np.diag([0.01, 0.02, 0.1])
    stiffness = np.array([[5e3, -5e3, 0.0], [-5e3, 1.4e4, -9e3], [0.0, -9e3, 9.5e3]])
    return mass, stiffness


@functools.cache
def matrix_archives() -> tuple[bytes, ...]:
    from lostmotion.io.tables.matrices import save_torsional_model

    model = lm.structure.TorsionalModel(*_model())
    return (_saved(lambda path: save_torsional_model(model, path)),)


@functools.cache
def matrix_texts() -> tuple[bytes, ...]:
    out = io.StringIO()
    np.savetxt(out, _model()[1], delimiter=",")
    return (out.getvalue().encode(),)


@functools.cache
def matrix_markets() -> tuple[bytes, ...]:
    from scipy.io import mmwrite
    from scipy.sparse import coo_array

    made = []
    for matrix in (_model()[1], coo_array(_model()[1])):
        out = io.BytesIO()
        mmwrite(out, matrix)
        made.append(out.getvalue())
    return tuple(made)


def _read_matrices(path: Path) -> object:
    from lostmotion.io.tables.matrices import read_torsional_model

    return read_torsional_model(path, None if path.suffix == ".npz" else path)


def _retyped(data: bytes, rng: random.Random) -> bytes:
    """Numbers and sizes of a text with matrices changed."""
    text = fuzz_tables.changed_csv(data, rng).replace(
        b"3 3", rng.choice((b"3 3", b"99999999 99999999", b"-1 3", b"3"))
    )
    return text.replace(b"real", rng.choice((b"real", b"complex", b"pattern", b"integer", b"x")))


def _batch(trajectories: bool) -> bytes:
    """The file of a finished chunk, or that with its trajectories."""
    with tempfile.TemporaryDirectory() as folder:
        lm.simulate_batch(
            [_plant()],
            dt=1e-3,
            torque_motor=TORQUE,
            folder=folder,
            trajectories=True,
            quantiles=("twist",),
            workers=1,
        )
        found = [p for p in Path(folder).iterdir() if p.name.endswith(".summary.npz") != trajectories]
        return found[0].read_bytes()


@functools.cache
def chunks() -> tuple[bytes, ...]:
    return (_batch(trajectories=False),)


@functools.cache
def trajectories() -> tuple[bytes, ...]:
    return (_batch(trajectories=True),)


@functools.cache
def score_files() -> tuple[bytes, ...]:
    from lostmotion.compare.score_cache import ScoreCache

    with tempfile.TemporaryDirectory() as folder:
        ScoreCache(Path(folder), "long").add("ideal", 1, {"kalman": {"speed_load": 0.5, "twist": None}})
        return (next(Path(folder).rglob("*.json")).read_bytes(),)


def _read_scores(path: Path) -> object:
    from lostmotion.compare.score_cache import ScoreCache

    cache = ScoreCache(path.parent, "long")
    assert cache.folder is not None
    path.replace(cache.folder / "ideal__1.json")
    return cache.scores("ideal", 1) or None


@functools.cache
def boards() -> tuple[bytes, ...]:
    content = {
        "observers": [{"name": "an observer of an older version"}],
        "cases": [{"name": "a case of an older version"}],
        "seeds": [],
        "settings": {"duration": 1.0, "part": False},
    }
    return (json.dumps(content).encode(),)


def _read_board(path: Path) -> object:
    from lostmotion.compare.leaderboard import Leaderboard
    from lostmotion.compare.whole_table import keep_whole_table

    new = Leaderboard({}, (), (), {}, {"duration": 1.0})
    keep_whole_table(path.parent, new, "observers", ["kalman"], ["nominal"])
    return path


def _read_chunk(path: Path) -> object:
    from lostmotion.simulation.batch.store import _chunk

    return _chunk(path)


FORMATS = (
    Format("law.json", "law.json", laws, _law_rewritten, lm.load_law),
    Format("law.json of a stepper", "law.json", steppers, _law_rewritten, lm.load_law),
    Format("recording .npz", "rig.npz", recordings, fuzz_tables.changed_npz, files.read_recording),
    Format("CSV", "rig.csv", csv_tables, fuzz_tables.changed_csv, _read_csv),
    Format("MAT", "rig.mat", mat_files, fuzz_tables.changed_mat, _read_mat),
    Format("TOML", "rig.toml", configurations, _toml_rewritten, files.read_configuration),
    Format("drivetrain.toml", "drivetrain.toml", drivetrains, _toml_rewritten, lm.load_drivetrain),
    Format("results.json", "results.json", results, _json_rewritten, lambda path: files.load_json(path, "results")),
    Format(
        "manifest", ".lostmotion-files.json", manifests, _json_rewritten, lambda path: files.foreign_files(path.parent)
    ),
    Format("chunk of a batch", "variants-000000.summary.npz", chunks, fuzz_tables.changed_npz, _read_chunk),
    Format(
        "trajectories",
        "variants-000000.npz",
        trajectories,
        fuzz_tables.changed_npz,
        lambda path: lm.simulation.read_trajectories(path.parent, 0),
    ),
    Format("scores", "ideal__1.json", score_files, _json_rewritten, _read_scores),
    Format("leaderboard.json", "leaderboard.json", boards, _json_rewritten, _read_board),
    Format("matrices .npz", "m.npz", matrix_archives, fuzz_tables.changed_npz, _read_matrices),
    Format("matrices .csv", "m.csv", matrix_texts, _retyped, _read_matrices),
    Format("matrices .mtx", "m.mtx", matrix_markets, _retyped, _read_matrices),
)  # fmt: skip
