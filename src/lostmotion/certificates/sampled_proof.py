"""The inequalities that prove the sampled loop stable, linear in matrices and multipliers.

::

    V(ξ, τ) = ξᵀ P(τ) ξ + 2 Σ ηᵢ ∫wᵢ + 2 Σ θⱼ ∫vⱼ        P piecewise linear in the time τ since the last sample

falls between samples and does not rise at a sample: docs/proofs.md, equations 10 to 15. The same
lines run in floats for the solver and in fractions for the check. Terms with a multiplier of zero are left out: the
solver takes the coefficients of one unknown after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from .equilibrium import Equilibrium
from .lure import LoopMatrices, LureLoop
from .rational import Matrix, rational
from .sectors import Copies, Region, Sector
from .semidefinite import Layout, Unknowns


class Evaluation(NamedTuple):
    """One curve at one moment: rows of its argument and of its value over the vector of a condition.

    ``curve`` numbers the plant's curves, then the law's.
    """

    curve: int
    argument: Matrix
    value: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class SampledProof(LoopMatrices):
    """What is to be proved, in fractions (or, for the solver, floats).

    Parameters
    ----------
    A, E : arrays
        Flow over one substep of P: those of ``LureLoop`` times dt / substeps.
    Z, S, S_w, S_v, N, N_w, N_v : arrays
        As in ``LureLoop``.
    sectors : (p + q, 2) array
    slopes : (p + q,) array
        At the equilibrium.
    steepest : (p + q,) array
        Largest slopes; None for a jump.
    copies : tuple of Copies
    of_state : tuple of int
        Rising law curves without a jump whose argument the law's state alone decides: V has their integrals.
    seen : tuple of int
        Plant curves that count at a sample: the law reads them, or has copies of them.
    substeps : int
    limit : int or None
        Law curve that is the torque limit, where the proof holds in a sublevel set of V alone: its sector is that of a
        region of its argument.
    reach : (1, 1) array or None
        Half the width of that region, in the argument's unit.
    start : (1, n) array or None
        Deviation of the state from which V must stay in the region.
    """

    sectors: Matrix
    slopes: Matrix
    steepest: Matrix
    copies: tuple[Copies, ...]
    of_state: tuple[int, ...]
    seen: tuple[int, ...]
    substeps: int
    limit: int | None = None
    reach: Matrix | None = None
    start: Matrix | None = None

    def floats(self) -> SampledProof:
        """The same in floats."""
        arrays: dict[str, Any] = {
            f.name: np.where(value == None, np.inf, value).astype(float)  # noqa: E711 (elementwise)
            for f in fields(self)
            if isinstance(value := getattr(self, f.name), np.ndarray)
        }
        copies = tuple(Copies(c.first, c.second, *map(float, c[2:])) for c in self.copies)
        return replace(self, **arrays, copies=copies)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of states, plant curves, law curves."""
        return self.A.shape[0], self.E.shape[1], self.S_v.shape[1]

    @property
    def size(self) -> int:
        """Rows of P: over ζ = (ξ, v of the curves of the law's state)."""
        return self.A.shape[0] + len(self.of_state)

    def layout(self) -> Layout:
        """Names and sizes of the unknowns of ``conditions``."""
        _, p, _ = self.sizes
        knots, ends = self.substeps + 1, 2 * self.substeps
        _, still = self.rest
        _, flowing = self.flow
        _, jumping = self.sample
        return Layout(
            {f"P{k}": self.size for k in range(knots)},
            {
                "eta_plus": p,
                "eta_minus": p,
                "theta_plus": len(self.of_state),
                "theta_minus": len(self.of_state),
                "rest_sectors": knots * len(still),
                "rest_copies": knots * len(self.pairs(still)),
                "flow_sectors": ends * len(flowing),
                "flow_copies": ends * len(self.pairs(flowing)),
                "jump_sectors": len(jumping),
                "jump_copies": len(self.pairs(jumping)),
                **self._region_layout(),
            },
        )

    def _region_layout(self) -> dict[str, int]:
        """Multipliers of ``contains``."""
        if self.limit is None:
            return {}
        _, before = self.before_sample
        return {"level": 1, "region_sectors": len(before), "region_copies": len(self.pairs(before))}

    def conditions(self, unknowns: Unknowns) -> list[Matrix]:
        """Matrices that must be positive definite: V at each knot, its fall along each substep, and at the sample."""
        knots = range(self.substeps + 1)
        return [
            *(self.positive(unknowns, k) for k in knots),
            *(self.falls(unknowns, k, end) for k in range(self.substeps) for end in (0, 1)),
            self.does_not_rise(unknowns),
            *([] if self.limit is None else [self.contains(unknowns), self.starts_inside(unknowns)]),
        ]

    @cached_property
    def rest(self) -> tuple[Matrix, list[Evaluation]]:
        """Rows of ζ over itself, and the law's curves in it."""
        zeta = self._rows(self.size)
        return zeta, self._of_state(zeta[: self.A.shape[0]], zeta)

    @cached_property
    def flow(self) -> tuple[tuple[Matrix, Matrix, Matrix], list[Evaluation]]:
        """Rows over (ζ, w) of ζ, of its rate times the length of a substep, and of z's; all curves."""
        n, p, _ = self.sizes
        one = self._rows(self.size + p)
        zeta, w = one[: self.size], one[self.size :]
        rate = 0 * zeta
        rate[:n] = self.A @ zeta[:n] + self.E @ w
        plant = [Evaluation(i, self.Z[i] @ zeta[:n], w[i]) for i in range(p)]
        return (zeta, rate, self.Z @ rate[:n]), plant + self._of_state(zeta[:n], zeta)

    @cached_property
    def sample(self) -> tuple[tuple[Matrix, Matrix, dict[int, Any]], list[Evaluation]]:
        """Rows over (ξ, w seen, v, v after the sample) of ζ and ζ⁺, of the integrals' ends, and all evaluations."""
        n, p, q = self.sizes
        one = self._rows(n + len(self.seen) + q + len(self.of_state))
        xi, v = one[:n], one[n + len(self.seen) :][:q]
        w, later = 0 * one[:p], 0 * v
        for place, i in enumerate(self.seen):
            w[i] = one[n + place]
        for place, j in enumerate(self.of_state):
            later[j] = one[n + len(self.seen) + q + place]
        s = self.N @ xi + self.N_w @ w + self.N_v @ v
        jumped = self.S @ xi + self.S_w @ w + self.S_v @ v
        s_later = self.N @ jumped + self.N_v @ later
        z = self.Z @ xi
        evaluations = [Evaluation(i, z[i], w[i]) for i in self.seen]
        evaluations += [Evaluation(p + j, s[j], v[j]) for j in range(q)]
        evaluations += [Evaluation(p + j, s_later[j], later[j]) for j in self.of_state]
        ends = {j: (s[j], v[j], s_later[j], later[j]) for j in self.of_state}
        kept = list(self.of_state)
        return (np.vstack([xi, v[kept]]), np.vstack([jumped, later[kept]]), ends), evaluations

    @cached_property
    def before_sample(self) -> tuple[Matrix, list[Evaluation]]:
        """Rows over (ξ, w seen, v) of ξ, and all evaluations."""
        n, p, q = self.sizes
        one = self._rows(n + len(self.seen) + q)
        xi, v, w = one[:n], one[n + len(self.seen) :], 0 * one[:p]
        for place, i in enumerate(self.seen):
            w[i] = one[n + place]
        s = self.N @ xi + self.N_w @ w + self.N_v @ v
        plant = [Evaluation(i, self.Z[i] @ xi, w[i]) for i in self.seen]
        return xi, plant + [Evaluation(p + j, s[j], v[j]) for j in range(q)]

    def positive(self, unknowns: Unknowns, k: int) -> Matrix:
        """V at knot k over ζ, with each negative integral at its largest (equation 12)."""
        zeta, evaluations = self.rest
        form = self._least(unknowns, k, zeta[: self.A.shape[0]], evaluations)
        return form - self._known(unknowns, "rest", k, self.substeps + 1)

    def contains(self, unknowns: Unknowns) -> Matrix:
        """V before a sample minus level times the square of the limit's argument (equation 17)."""
        xi, evaluations = self.before_sample
        p = self.sizes[1]
        laws = {e.curve - p: e for e in evaluations if e.curve >= p}
        form = self._least(unknowns, self.substeps, xi, [laws[j] for j in self.of_state])
        form = form - unknowns["level"][0] * _square(laws[self.limit or 0].argument)
        return form - self._known(unknowns, "region", 0, 1)

    def starts_inside(self, unknowns: Unknowns) -> Matrix:
        """What the level leaves for V at the start, where every curve rests on its segment (equation 18)."""
        assert self.reach is not None and self.start is not None
        n = self.A.shape[0]
        v = self.start @ unknowns[f"P{self.substeps}"][:n, :n] @ self.start.T
        return unknowns["level"][0] * self.reach**2 - v

    def _least(self, unknowns: Unknowns, k: int, xi: Matrix, of_state: Sequence[Evaluation]) -> Matrix:
        """What V at knot k is at least, by rows of ξ and the law's curves in it (equation 11)."""
        zeta = np.vstack([xi, *(e.value for e in of_state)])
        form = zeta.T @ unknowns[f"P{k}"] @ zeta
        for i, eta in enumerate(unknowns["eta_minus"]):
            if eta:
                form = form - eta * self.sectors[i, 1] * _square(self.Z[i] @ xi)
        for theta, e in zip(unknowns["theta_minus"], of_state, strict=True):
            if theta:
                form = form - theta * self.sectors[e.curve, 1] * _square(e.argument)
        return form

    def falls(self, unknowns: Unknowns, k: int, end: int) -> Matrix:
        """−dV/dτ over (ζ, w) at one end of substep k, in the sectors (equation 13)."""
        (zeta, rate, z_rate), evaluations = self.flow
        form = zeta.T @ (unknowns[f"P{k + 1}"] - unknowns[f"P{k}"]) @ zeta
        form = form + twice_sum(unknowns[f"P{k + end}"] @ zeta, rate)
        eta = unknowns["eta_plus"] - unknowns["eta_minus"]
        for i in np.flatnonzero(eta):
            form = form + eta[i] * twice_product(evaluations[i].value, z_rate[i])
        return -form - self._known(unknowns, "flow", 2 * k + end, 2 * self.substeps)

    def does_not_rise(self, unknowns: Unknowns) -> Matrix:
        """V before minus V after a sample, in the sectors and with the curves' copies (equations 14 to 16)."""
        (zeta, jumped, ends), _ = self.sample
        form = jumped.T @ unknowns["P0"] @ jumped - zeta.T @ unknowns[f"P{self.substeps}"] @ zeta
        p = self.sizes[1]
        for place, (j, (s, v, s_later, later)) in enumerate(ends.items()):
            if not (unknowns["theta_plus"][place] or unknowns["theta_minus"][place]):
                continue
            curvature = _square(later - v) / self.steepest[p + j]
            rise, fall = twice_product(later, s_later - s), twice_product(v, s_later - s)
            form = form + unknowns["theta_plus"][place] * (rise - curvature)
            form = form - unknowns["theta_minus"][place] * (fall + curvature)
        return -form - self._known(unknowns, "jump", 0, 1)

    def pairs(self, evaluations: Sequence[Evaluation]) -> list[tuple[Evaluation, Evaluation, Any, Any, Any]]:
        """Pairs of evaluations of one curve, or of copies of it, with slope, slack and loss."""
        known = {(c.first, c.second): c[2:] for c in self.copies}
        found: list[tuple[Evaluation, Evaluation, Any, Any, Any]] = []
        for a, b in combinations(evaluations, 2):
            places = min(a.curve, b.curve), max(a.curve, b.curve)
            if a.curve == b.curve:
                found.append((a, b, self.steepest[a.curve], 0, 0))
            elif places in known:
                found.append((a, b, *known[places]))
        return found

    @cached_property
    def facts(self) -> dict[str, Matrix]:
        """What is known of the curves at rest, in the flow, at and before a sample: forms ≥ 0, sectors then copies."""
        where = {"rest": self.rest, "flow": self.flow, "jump": self.sample, "region": self.before_sample}
        return {name: self._forms(evaluations) for name, (_, evaluations) in where.items()}

    def _forms(self, evaluations: Sequence[Evaluation]) -> Matrix:
        """Twice the products of equations 7 and 8, one matrix for each multiplier."""
        forms = []
        for e in evaluations:
            low, high = self.sectors[e.curve]
            forms.append(twice_product(e.value - low * e.argument, high * e.argument - e.value))
        for a, b, steepest, slack, loss in self.pairs(evaluations):
            rise, apart = a.value - b.value, a.argument - b.argument
            forms.append(twice_product(rise, steepest * apart - (1 - slack) * rise))
            if loss:
                forms[-1] = forms[-1] + 2 * loss * (_square(a.argument) + _square(b.argument))
        return np.array(forms)

    def _known(self, unknowns: Unknowns, where: str, part: int, parts: int) -> Matrix:
        """What is known of the curves times its multipliers, in one of the parts of a condition."""
        each = [unknowns[f"{where}_{kind}"].reshape(parts, -1)[part] for kind in ("sectors", "copies")]
        multipliers = np.concatenate(each)
        if not np.any(multipliers):
            return np.asarray(0)
        return np.asarray(np.tensordot(multipliers, self.facts[where], 1))

    def _of_state(self, xi: Matrix, zeta: Matrix) -> list[Evaluation]:
        """The law's curves in ζ, by rows of ξ and ζ."""
        n, p, q = self.sizes
        v = 0 * zeta[:1].repeat(q, axis=0)
        for place, j in enumerate(self.of_state):
            v[j] = zeta[n + place]
        s = self.N @ xi + self.N_v @ v
        return [Evaluation(p + j, s[j], v[j]) for j in self.of_state]

    def _rows(self, size: int) -> Matrix:
        return rational(np.eye(size)) if self.A.dtype == object else np.eye(size)


def sampled_proof(
    loop: LureLoop,
    corner: Equilibrium,
    sectors: Sequence[Sector],
    copies: Sequence[Copies],
    substeps: int = 1,
    region: Region | None = None,
) -> SampledProof:
    """The problem for a loop without the law curves that hang on the set-point alone: they stand still.

    With a region, the sector of the torque limit among ``sectors`` is that of the region, and its copies do not count:
    equation 17 asks what a limit that does not act would do.
    """
    p = len(loop.plant_curves)
    if region is not None:
        copies = [c for c in copies if p + region.limit not in (c.first, c.second)]
    moving: list[int] = []
    for j in range(len(loop.law_curves)):
        inside = set(map(int, np.flatnonzero(loop.N_v[j])))
        if np.any(loop.N[j]) or np.any(loop.N_w[j]) or inside & set(moving):
            moving.append(j)
    curves = (*loop.plant_curves, *(loop.law_curves[j] for j in moving))
    kept = {old: new for new, old in enumerate((*range(p), *(p + j for j in moving)))}
    n, n_w, n_v = loop.N[moving], loop.N_w[moving], loop.N_v[np.ix_(moving, moving)]
    of_state: list[int] = []
    for j, curve in enumerate(curves[p:]):
        alone = not np.any(n[j, : loop.plant_size + 1]) and not np.any(n_w[j])
        inside = set(map(int, np.flatnonzero(n_v[j])))
        integrated = alone and inside <= set(of_state) and curve.rises and curve.steepest
        if integrated and not (region and moving[j] == loop.limit):
            of_state.append(j)
    known = tuple(
        c._replace(first=kept[c.first], second=kept[c.second])
        for c in copies
        if c.first in kept and c.second in kept
    )
    read = {*map(int, np.flatnonzero(loop.S_w.any(axis=0))), *map(int, np.flatnonzero(n_w.any(axis=0)))}
    read |= {c.first for c in known if c.first < p <= c.second}
    step = loop.dt / substeps
    bounds = [sectors[i] for i in kept]
    steepest = np.empty(len(curves), dtype=object)
    steepest[:] = [curve.steepest for curve in curves]
    slopes = [curve.slopes[corner.segments[i]] for i, curve in zip(kept, curves, strict=True)]
    return SampledProof(
        A=loop.A * step, E=loop.E * step, Z=loop.Z, S=loop.S, S_w=loop.S_w, S_v=loop.S_v[:, moving],
        N=n, N_w=n_w, N_v=n_v, sectors=rational([[s.low, s.high] for s in bounds]).reshape(len(curves), 2),
        slopes=rational(slopes), steepest=steepest, copies=known,
        of_state=tuple(of_state), seen=tuple(sorted(read)), substeps=substeps,
        limit=None if region is None else moving.index(region.limit),
        reach=None if region is None else rational([[region.reach]]),
        start=None if region is None else region.start[np.newaxis],
    )  # fmt: skip


def _square(row: Matrix) -> Matrix:
    return np.outer(row, row)


def twice_product(a: Matrix, b: Matrix) -> Matrix:
    """The form 2 (a·x)(b·x)."""
    return np.outer(a, b) + np.outer(b, a)


def twice_sum(a: Matrix, b: Matrix) -> Matrix:
    """The form 2 Σ (aᵢ·x)(bᵢ·x)."""
    form = a.T @ b
    return form + form.T
