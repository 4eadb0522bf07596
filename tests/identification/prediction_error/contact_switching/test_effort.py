"""What a search has computed is counted alike on every machine, and ends it."""

from __future__ import annotations

from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.effort import Effort
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate, side_by_side
from lostmotion.identification.prediction_error.contact_switching.moves.random_moves import wandering
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.search import final_fits, room
from lostmotion.identification.prediction_error.contact_switching.search.descents import Search


@pytest.fixture
def best(flt: ContactFilter, values: dict[str, float]) -> Candidate:
    part = replace(flt.liveliest(2000), effort=Effort())
    theta = part.theta(values)
    free = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]
    return Candidate("truth", theta, part.run(theta).cost, part, free)


def test_passes_count_their_rows_their_changes_and_their_sensitivities(best: Candidate):
    flt, theta = best.flt, best.theta
    plain = flt.effort.steps
    assert flt.rows < plain < 4 * flt.rows  # contacts and friction change within a sample
    flt.run(theta, best.free[:3])
    assert flt.effort.steps == 3 * plain
    # Without a gap nothing but the friction changes.
    other = replace(flt, effort=Effort())
    other.run(flt.changed(theta, backlash=0.0))
    assert flt.rows <= other.effort.steps < plain


def test_all_parts_of_a_recording_count_together_on_any_thread(best: Candidate):
    flt = best.flt
    before = flt.effort.steps
    parts = [flt.part(slice(0, 1000)), replace(flt, ramp=True), replace(flt, level=2.0 * flt.level)]
    side_by_side(lambda one: one.run(best.theta), parts * 4)
    first = flt.effort.steps - before
    side_by_side(lambda one: one.run(best.theta), parts * 4)
    assert flt.effort.steps == before + 2 * first


def test_nothing_new_begins_after_a_long_search(
    flt: ContactFilter, plant: lm.Drivetrain, best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    search = Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05))
    lost = replace(best, cost=1.0)
    assert not search.ended([lost]) and search.ended([lost, replace(best, cost=0.0)])
    monkeypatch.setattr(room, "LONG", search.flt.effort.steps - 1)
    assert search.ended([lost]) and search.with_other_gaps([lost]) == []
    assert wandering(lost, best.flt, search.box, best.free, lambda: search.long) == []


def test_nothing_new_begins_where_the_drive_is_known(
    flt: ContactFilter, plant: lm.Drivetrain, best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    """Some innovations are left, but few."""
    search = Search.of(flt, plant, plant, (), None, (plant.inertia_total, 0.05))
    near, far = (replace(best, cost=factor * room.KNOWN) for factor in (0.9, 1.1))
    assert search.ended([near]) and not search.ended([far])
    # What has a superfluous part, and is a little likelier, knows the drive less well.
    superfluous = replace(near, free=[*near.free, INDEX["share"]], cost=near.cost - 1e-6)
    monkeypatch.setattr(room, "sharp", lambda one: one.free == near.free)
    assert search.ended([superfluous, near]) and not search.ended([superfluous])
    monkeypatch.setattr(room, "sharp", lambda _: False)
    assert not search.ended([near])


def test_the_last_fits_are_over_as_many_rows_as_one_pass_may_take(
    best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    assert final_fits._rows(best) <= final_fits.STEPS
    per_row = best.flt.effort.steps / best.flt.rows / 2.0  # of this run and that of the fixture
    monkeypatch.setattr(final_fits, "STEPS", 1000)
    assert final_fits._rows(best) == pytest.approx(1000.0 / per_row, abs=1.0)
    gapless = replace(best, theta=best.flt.changed(best.theta, backlash=0.0, coulomb=0.0))
    assert final_fits._rows(gapless) == 1000  # nothing changes within a row
