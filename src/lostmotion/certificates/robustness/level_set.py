"""The conditions that a level set of V holds every motion: linear in V's matrices and multipliers.

::

    V = (ξ, w)ᵀ P(τ) (ξ, w) + 2 Σ ηᵢ wᵢ zᵢ        w of the saturations in the square, of the jumps in the sum

The same lines run in floats for the solver and in fractions for the check. docs/proofs.md, equations 28 to 32.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..lure import LoopMatrices
from ..rational import Matrix, identity
from ..semidefinite import Layout, Unknowns
from .curve_relations import CurveShape, Moment, Reading, product, relations, square


class LevelSet(NamedTuple):
    """V ≤ level: P at each knot, and η of each jump."""

    P: tuple[Matrix, ...]
    eta: Matrix
    level: Any


class Output(NamedTuple):
    """A signal, row·(ξ, w), whose peak is asked for; ``before_sample``: it counts as the sample comes, and its row is
    over (ξ, w, v)."""

    row: Matrix
    before_sample: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class LevelSetProblem(LoopMatrices):
    """What is to be proved, in fractions (or, for the solver, floats).

    Parameters
    ----------
    A, E : arrays
        Flow over one substep of P: those of ``LureLoop`` times dt / substeps.
    R, M : (n, 1), (q, 1) array
        Those of ``LureLoop`` times the largest set-point; of a law in continuous time R over a substep, too.
    shapes : tuple of CurveShape
        Of the plant's curves, then the law's.
    sampled : bool
        Whether there is a sample at all.
    substeps : int
        Intervals of P over a sample.
    signals : (m, n + p) array
        Rows over (ξ, w) of what is known to stay within ±1.
    widths : tuple
        Bounds of the curves' arguments, or None.
    known : tuple of LevelSet
        That every motion stays in.
    rate : number
        Decay of V towards the level over a substep, half of it at the sample where there is one.
    output : Output
    """

    R: Matrix
    M: Matrix
    shapes: tuple[CurveShape, ...]
    sampled: bool
    substeps: int
    signals: Matrix
    widths: tuple[Any, ...]
    known: tuple[LevelSet, ...]
    rate: Any
    output: Output

    def floats(self) -> LevelSetProblem:
        """The same in floats."""
        arrays: dict[str, Any] = {
            f.name: value.astype(float)
            for f in fields(self)
            if isinstance(value := getattr(self, f.name), np.ndarray)
        }
        return replace(
            self, **arrays, rate=float(self.rate), shapes=tuple(shape.floats() for shape in self.shapes),
            widths=tuple(None if width is None else float(width) for width in self.widths),
            known=tuple(
                LevelSet(tuple(p.astype(float) for p in k.P), k.eta.astype(float), float(k.level)) for k in self.known
            ),
            output=self.output._replace(row=self.output.row.astype(float)),
        )  # fmt: skip

    @property
    def smooth(self) -> list[int]:
        """Plant curves that saturate."""
        return [i for i in range(self.E.shape[1]) if self.shapes[i].steepest is not None]

    @property
    def jumps(self) -> list[int]:
        """Plant curves that jump."""
        return [i for i in range(self.E.shape[1]) if self.shapes[i].steepest is None]

    @property
    def knots(self) -> int:
        """Numbers of P."""
        return self.substeps + 1 if self.sampled else 1

    @property
    def ends(self) -> int:
        """Ends of substeps at which V must fall."""
        return 2 * self.substeps if self.sampled else 1

    @property
    def asked(self) -> list[int]:
        """Knots at which the output counts."""
        return [self.knots - 1] if self.output.before_sample else list(range(self.knots))

    def layout(self) -> Layout:
        """Names and sizes of the unknowns of ``conditions``."""
        size = self.A.shape[0] + len(self.smooth)
        count = {name: tuple(map(len, forms)) for name, (_, forms) in self.moments.items()}
        free = {f"flow_{e}": count["flow"][1] for e in range(self.ends)}
        free |= {f"output_{k}": count["output"][1] for k in self.asked}
        some = {f"flow_{e}": count["flow"][0] for e in range(self.ends)}
        some |= {f"output_{k}": count["output"][0] for k in self.asked}
        some |= {f"flow_known_{k}": len(self.known) for k in range(self.substeps)}
        if self.sampled:
            free["sample"], some["sample"] = count["sample"][1], count["sample"][0]
            some["sample_known"] = len(self.known)
        return Layout(
            {f"P{k}": size for k in range(self.knots)}
            | {f"{name}_zero_{i}": 1 for name, number in free.items() for i in range(number)},
            {**some, "eta": len(self.jumps), "level": 1, "gain": 1},
        )

    def conditions(self, unknowns: Unknowns) -> list[Matrix]:
        """Matrices that must be positive definite."""
        found = [self._falls(unknowns, e) for e in range(self.ends)]
        found += [self._output(unknowns, k) for k in self.asked]
        return found + ([self._stays(unknowns)] if self.sampled else [])

    def found(self, unknowns: Unknowns) -> LevelSet:
        """The level set of a solution."""
        return LevelSet(
            tuple(unknowns[f"P{k}"] for k in range(self.knots)), unknowns["eta"], unknowns["level"][0]
        )

    @cached_property
    def moments(self) -> dict[str, tuple[dict[str, Matrix], tuple[list[Matrix], list[Matrix]]]]:
        """For each kind of condition: rows by name, and the relations of the curves."""
        p, q = self.E.shape[1], self.N.shape[0]
        plant, law = list(range(p)), list(range(q))
        given = {"reference": 1}
        found = {
            # Without the constant 1 nothing bounds a jump or the set-point: they are left out (``_output``).
            "output": self._moment(self.smooth, self.inner if self.output.before_sample else [], {}),
            "flow": self._moment(
                plant, [], {"rate": len(self.smooth), **({} if self.sampled else given), "one": 1}
            ),
        }
        if self.sampled:
            found["sample"] = self._moment(plant, law, {**given, "one": 1})
        return found

    @property
    def inner(self) -> list[int]:
        """Law curves whose arguments do not hang on the set-point of their own sample."""
        return inner_curves(self.N_v, self.M)

    def _moment(
        self, plant: list[int], law: list[int], further: dict[str, int]
    ) -> tuple[dict[str, Matrix], tuple[list[Matrix], list[Matrix]]]:
        """Of these curves; rows w and v of the others are zero."""
        (p, n), q = self.Z.shape, self.N.shape[0]
        sizes = {"state": n, "plant": len(plant), "law": len(law), **further}
        count = sum(sizes.values())
        unit = identity(count) if self.A.dtype == object else np.eye(count)
        ends = np.cumsum(list(sizes.values()))
        rows = {name: unit[end - size : end] for (name, size), end in zip(sizes.items(), ends, strict=True)}
        for name, own, size in (("w", plant, p), ("v", law, q)):
            rows[name] = np.zeros((size, count), dtype=unit.dtype) + 0 * unit[0]
            rows[name][own] = rows.pop("plant" if name == "w" else "law")
        state, w, v = rows["state"], rows["w"], rows["v"]
        readings = [Reading(i, self.Z[i] @ state, w[i]) for i in plant]
        arguments = self.N @ state + self.N_w @ w + self.N_v @ v
        if "reference" in rows:
            arguments = arguments + self.M @ rows["reference"]
        readings += [Reading(p + j, arguments[j], v[j]) for j in law]
        rates = {}
        if "rate" in rows:
            faster = self.Z @ self._rates(rows)
            rates = {i: (faster[i], rows["rate"][place]) for place, i in enumerate(self.smooth)}
        one = rows["one"][0] if "one" in rows else None
        signals = [*(self.signals @ np.vstack([state, w])), *rows.get("reference", ())]
        moment = Moment(readings, signals, one, rates)
        return rows, relations(moment, self.shapes, self.widths)

    def _rates(self, rows: dict[str, Matrix]) -> Matrix:
        """Rates of the states over a substep."""
        rates = self.A @ rows["state"] + self.E @ rows["w"]
        return rates if self.sampled else rates + self.R @ rows["reference"]

    def _v(self, p: Matrix, eta: Matrix, state: Matrix, w: Matrix) -> Matrix:
        """V over the vector of which these are rows."""
        form = _congruent(p, np.vstack([state, w[self.smooth]]))
        for i, each in zip(self.jumps, eta, strict=True):
            if each:
                form = form + 2 * each * product(w[i], self.Z[i] @ state)
        return form

    def _falls(self, unknowns: Unknowns, end: int) -> Matrix:
        """−dV/dτ − rate·(V − level) at one end of a substep (equation 30)."""
        rows, forms = self.moments["flow"]
        state, w, one = rows["state"], rows["w"], rows["one"][0]
        k = end // 2 + end % 2
        rate = self.rate / 2 if self.sampled else self.rate
        p, eta = unknowns[f"P{k}"], unknowns["eta"]
        zeta, moved = np.vstack([state, w[self.smooth]]), np.vstack([self._rates(rows), rows["rate"]])
        rise = _congruent(p, zeta, moved)
        rise = rise + rise.T
        if self.sampled:
            rise = rise + _congruent(unknowns[f"P{end // 2 + 1}"] - unknowns[f"P{end // 2}"], zeta)
        for i, each in zip(self.jumps, eta, strict=True):
            if each:
                rise = rise + 2 * each * product(w[i], self.Z[i] @ self._rates(rows))
        form = rate * (unknowns["level"][0] * square(one) - self._v(p, eta, state, w)) - rise
        form = form - self._known(unknowns[f"flow_known_{end // 2}"], k, state, w, one)
        return form - _combined(unknowns, f"flow_{end}", forms)

    def _stays(self, unknowns: Unknowns) -> Matrix:
        """level − V after a sample, where V before it is below the level (equation 31)."""
        rows, forms = self.moments["sample"]
        state, w, v, one = rows["state"], rows["w"], rows["v"], rows["one"][0]
        jumped = self.S @ state + self.S_w @ w + self.S_v @ v + self.R @ rows["reference"]
        last, eta = self.knots - 1, unknowns["eta"]
        share = 1 - self.rate * self.substeps / 2
        level = unknowns["level"][0] * square(one)
        before = level - self._v(unknowns[f"P{last}"], eta, state, w)
        form = level - self._v(unknowns["P0"], eta, jumped, w) - share * before
        form = form - self._known(unknowns["sample_known"], last, state, w, one)
        return form - _combined(unknowns, "sample", forms)

    def _output(self, unknowns: Unknowns, k: int) -> Matrix:
        """What V is at least, minus gain·output², at a knot (equation 32)."""
        rows, forms = self.moments["output"]
        state, w = rows["state"], rows["w"]
        form = _congruent(unknowns[f"P{k}"], np.vstack([state, w[self.smooth]]))
        for i, eta in zip(self.jumps, unknowns["eta"], strict=True):
            # w·z ≥ low·|z|, and |z| is at most the width.
            if eta and self.widths[i] is not None:
                form = form + 2 * eta * self.shapes[i].low / self.widths[i] * square(self.Z[i] @ state)
        own = np.vstack([state, w, *([rows["v"]] if self.output.before_sample else [])])
        form = form - unknowns["gain"][0] * square(self.output.row @ own)
        return form - _combined(unknowns, f"output_{k}", forms)

    def _known(self, multipliers: Matrix, k: int, state: Matrix, w: Matrix, one: Matrix) -> Matrix:
        """Multiples of level − V of the sets that are known."""
        form = 0 * square(one)
        for multiplier, known in zip(multipliers, self.known, strict=True):
            if multiplier:
                inside = known.level * square(one) - self._v(known.P[k], known.eta, state, w)
                form = form + multiplier * inside
        return form


def inner_curves(by_law: Matrix, by_reference: Matrix) -> list[int]:
    """Law curves whose arguments do not hang on the set-point of their own sample, directly or by other curves."""
    found: list[int] = []
    for j, row in enumerate(by_law):
        if not by_reference[j, 0] and set(map(int, np.flatnonzero(row))) <= set(found):
            found.append(j)
    return found


def _congruent(p: Matrix, left: Matrix, right: Matrix | None = None) -> Matrix:
    """leftᵀ P right; the solver asks for one coefficient after the other, so most P are zero."""
    right = left if right is None else right
    return left.T @ p @ right if np.any(p) else np.zeros((left.shape[1],) * 2, dtype=p.dtype)


def _combined(unknowns: Unknowns, name: str, forms: tuple[list[Matrix], list[Matrix]]) -> Any:
    """Multiples of the relations; 0 where there are none."""
    total: Any = 0
    for multiplier, form in zip(unknowns[name], forms[0], strict=True):
        if multiplier:
            total = total + multiplier * form
    for i, form in enumerate(forms[1]):
        if multiplier := unknowns[f"{name}_zero_{i}"][0, 0]:
            total = total + multiplier * form
    return total
