"""The last fits: what is compared with the best of them, and where that begins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import LAWS, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, cost_of
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.search import final_fits
from lostmotion.identification.prediction_error.contact_switching.search.descents import Search


def test_fits_under_other_laws_differ_from_the_best_in_the_law_or_the_torque_alone(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    """Even where the best has a part that the first fits lack, and where these are of a poorer law."""
    search = Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05))
    rows = flt.liveliest(3000)
    search = replace(search, flt=rows, part=rows)
    friction = INDEX["coulomb"]
    free = sorted({INDEX[name] for name in TOLD} - {friction})
    begun = rows.theta(values | {"coulomb": 0.5 * plant.coulomb})
    poor = Candidate("start", begun, 0.0, replace(rows, law="dead_zone"), free)
    poor = replace(poor, cost=poor.flt.run(begun).cost)

    def with_friction(one: Candidate) -> Candidate:
        """Right, and under the right law."""
        right = replace(one.flt, law="viscoelastic")
        return replace(
            one,
            start="part",
            theta=right.changed(one.theta, **values),
            free=sorted({*free, friction}),
            flt=right,
        )

    seen: list[tuple[Candidate, Sequence[Candidate]]] = []

    def noted(best: Candidate, under_laws: Sequence[Candidate], box: Box) -> np.ndarray:
        seen.append((best, under_laws))
        return np.zeros(len(TOLD))

    monkeypatch.setattr(final_fits, "with_better_backlash", lambda best, box: [])
    monkeypatch.setattr(final_fits, "other_parts", lambda *_: [with_friction])
    monkeypatch.setattr(final_fits, "clearly_better", lambda *_: False)
    monkeypatch.setattr(Search, "is_the_drive", lambda *_: False)
    monkeypatch.setattr(final_fits, "disagreement", noted)
    found = final_fits.estimate(search, [poor])
    [(best, under_laws)] = seen
    assert found is not None and friction in best.free
    [straight] = [one for one in under_laws if one.flt.ramp is not best.flt.ramp]
    laws = [one for one in under_laws if one is not straight]
    assert sorted([best.flt.law, *(one.flt.law for one in laws)]) == sorted(LAWS)
    assert straight.flt.law == best.flt.law
    assert all(one.free == best.free and one.structure[2:] == best.structure[2:] for one in under_laws)
    assert best.cost <= min(map(cost_of, under_laws))


def test_a_gap_of_any_size_is_tried_over_more_rows(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float]
):
    """The few rows of the search may leave it fifty times too narrow, which no descent mends."""
    search = Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05))
    begun = flt.theta(values | {"backlash": plant.backlash / 50.0})
    poor = Candidate("start", begun, 0.0, search.part, sorted({INDEX[name] for name in TOLD}))
    found = final_fits.estimate(search, [replace(poor, cost=poor.flt.run(begun).cost)])
    assert found is not None
    assert np.exp(found.theta[TOLD.index("backlash")]) == pytest.approx(plant.backlash, rel=0.01)


def test_nothing_is_tried_where_the_best_is_the_drive(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    rows = flt.liveliest(3000)
    search = replace(Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05)), flt=rows, part=rows)
    drive = Candidate("start", rows.theta(values), 0.0, rows, sorted({INDEX[name] for name in TOLD}))
    drive = replace(drive, cost=rows.run(drive.theta).cost)
    tried: list[str] = []

    def noted(name: str) -> Callable[..., list[Candidate]]:
        return lambda *_: tried.append(name) or []

    monkeypatch.setattr(final_fits, "under_other_laws", noted("laws"))
    monkeypatch.setattr(Search, "with_any_backlash", noted("any gap"))
    monkeypatch.setattr(final_fits, "with_better_backlash", noted("better gap"))
    monkeypatch.setattr(final_fits, "other_parts", noted("parts"))
    monkeypatch.setattr(final_fits, "disagreement", lambda *_: tried.append("refits") or np.zeros(len(TOLD)))
    final_fits.estimate(search, [drive])
    assert tried == []
    monkeypatch.setattr(Search, "is_the_drive", lambda *_: False)
    final_fits.estimate(search, [drive])
    assert tried == ["laws", "any gap", "better gap", "parts", "refits"]


def test_what_is_clearly_worse_over_a_part_of_the_rows_is_not_fitted_to_all(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    rows = flt.liveliest(4000)
    search = replace(Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05)), flt=rows, part=rows)
    best = Candidate("best", rows.theta(values), 0.0, rows, [INDEX["stiffness"]])
    best = replace(best, cost=rows.run(best.theta).cost)
    near = replace(best, start="near", theta=rows.theta(values | {"stiffness": 1.01 * plant.stiffness}))
    # Its stiffness cannot make up for its load.
    far = replace(best, start="far", theta=rows.theta(values | {"inertia_load": 1.3 * plant.inertia_load}))
    fitted: list[int] = []
    original = Search.polished

    def noted(search: Search, candidates: Sequence[Candidate], over: ContactFilter) -> list[Candidate]:
        fitted.extend([over.rows] * len(candidates))
        return original(search, candidates, over)

    monkeypatch.setattr(Search, "polished", noted)
    [kept] = final_fits._not_worse(search, [far, near], best)
    assert fitted == [1000, 1000]
    assert kept.start == "near" and kept.flt.rows == 4000
    assert kept.cost == pytest.approx(rows.run(kept.theta).cost, abs=1e-12)
    assert kept.values["stiffness"] == pytest.approx(plant.stiffness, rel=2e-3)


def test_what_fits_the_noise_alone_is_no_part_of_the_drive(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    """A third inertia or a rising friction predicts a little better, and leaves all other values more room."""
    rows = flt.liveliest(3000)
    search = replace(Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05)), flt=rows, part=rows)
    drive = Candidate("start", rows.theta(values), 0.0, rows, sorted({INDEX[name] for name in TOLD}))
    seen: list[tuple[Candidate, Sequence[Candidate]]] = []

    def noted(best: Candidate, found: Sequence[Candidate], box: Box) -> np.ndarray:
        seen.append((best, found))
        return np.zeros(len(TOLD))

    monkeypatch.setattr(Search, "is_the_drive", lambda *_: False)
    monkeypatch.setattr(final_fits, "room_for_further_inertias", noted)
    monkeypatch.setattr(final_fits, "disagreement", lambda *_: np.zeros(len(TOLD)))
    final_fits.estimate(search, [replace(drive, cost=drive.flt.run(drive.theta).cost)])
    [(best, found)] = seen
    assert best.free == drive.free
    # Rounding has edges: nothing is likelier than the drive itself.
    assert rows.rounded or len(min(found, key=cost_of).free) > len(drive.free)


def test_friction_is_tried_afresh_over_more_rows(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    """Over the rows of the search a constant torque may have made up for friction at both ends."""
    rows = flt.liveliest(3000)
    search = replace(Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05)), flt=rows, part=rows)
    begun = rows.theta(values | {"coulomb": 30.0, "coulomb_motor": 30.0, "torque_offset": 60.0})
    poor = Candidate("start", begun, 0.0, rows, sorted(INDEX[name] for name in TOLD))
    poor = replace(poor, cost=rows.run(begun).cost)
    polished: list[Candidate] = []

    def noted(search: Search, candidates: Sequence[Candidate], *_: ContactFilter) -> list[Candidate]:
        polished.extend(candidates)
        return list(candidates)

    monkeypatch.setattr(Search, "polished", noted)
    final_fits.estimate(search, [poor])
    own = [INDEX[name] for name in ("coulomb", "viscous", "coulomb_motor", "viscous_motor", "torque_offset")]
    first, afresh, *_ = polished
    assert first.cost == pytest.approx(poor.cost) and first.start == "start"
    assert np.array_equal(afresh.theta[own], search.begun["nameplate"][own])
    assert np.array_equal(np.delete(afresh.theta, own), np.delete(begun, own))
