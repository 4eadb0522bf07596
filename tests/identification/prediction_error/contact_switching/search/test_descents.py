"""The search over starts: where it looks, and by which likelihood it judges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import EXPLAINED, TOLD, distance
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate
from lostmotion.identification.prediction_error.contact_switching.likelihood_ratio import simplest
from lostmotion.identification.prediction_error.contact_switching.moves.choices import with_other_torque
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.search import room
from lostmotion.identification.prediction_error.contact_switching.search.descents import (
    PATIENCE_KNOWN,
    Search,
)
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import bare
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import (
    Place,
    has_fourth,
)
from lostmotion.identification.prediction_error.innovations import Predictor


@pytest.fixture
def search(flt: ContactFilter, plant: lm.Drivetrain) -> Search:
    start = plant.with_parameters(stiffness=0.5 * plant.stiffness)
    return replace(
        Search.of(flt, start, plant, (), None, (plant.inertia_total, 0.05)), part=flt.liveliest(3000)
    )


@pytest.fixture
def best(search: Search, values: dict[str, float]) -> Candidate:
    theta = search.part.theta(values)
    free = sorted(INDEX[name] for name in TOLD)
    return Candidate("truth", theta, search.part.run(theta).cost, search.part, free)


def test_descents_from_the_grid_are_judged_by_one_likelihood(search: Search):
    """They come down with innovations divided out: their cost would be too low beside the others'."""
    found = search.from_grid()
    assert len({one.start for one in found}) == len(found) > 1
    for one in found:
        assert one.flt.charged and one.flt.rows == search.part.rows
        assert one.cost == pytest.approx(one.flt.run(one.theta).cost, abs=1e-12)


def test_race_and_third_inertias_are_left_out_where_a_start_is_the_drive(
    search: Search, best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    """Otherwise the grid is looked at, and a third inertia. Where the start lacks nothing, no choice is made anew."""
    looked: list[str] = []

    def noted(name: str) -> Callable[..., list[Candidate]]:
        return lambda *_: looked.append(name) or []

    monkeypatch.setattr(Search, "from_grid", noted("grid"))
    monkeypatch.setattr(Search, "thirds", noted("third"))
    monkeypatch.setattr(Search, "otherwise", noted("choices"))
    found = search.rivals(best)
    assert np.max(distance(simplest(found), best)[:4]) < 0.01
    # Steps lower the cost of Gaussian noise: of rounding they leave a little more than there is.
    assert {*looked} == ({"choices"} if search.part.rounded else set())
    looked.clear()
    search_of = "lostmotion.identification.prediction_error.contact_switching.search"
    for module in ("descents", "room"):
        monkeypatch.setattr(f"{search_of}.{module}.sharp", lambda _: False)
    search.rivals(best)
    assert [name for name in looked if name != "choices"] == ["grid", "third"]


def test_the_drive_is_known_and_leaves_nothing_but_noise(search: Search, best: Candidate):
    assert search.is_the_drive(best)
    assert not search.is_the_drive(replace(best, cost=1.1 * room.NOISE_ALONE))
    # A hundredth of the rows leaves the stiffness more than 5 % of room.
    few = search.part.part(slice(0, 200))
    assert not search.is_the_drive(replace(best, flt=replace(few, settling=0)))


def test_a_small_cost_is_chance_over_few_rows_alone(search: Search, best: Candidate):
    """25863: a backlash 30 % off cost 0.0154 over 25 000 rows, the drive 0.0035."""
    small = replace(best, cost=0.9 * room.NOISE_ALONE)
    assert room.noise_alone(small)
    often = replace(search.part, **{
        name: np.tile(getattr(search.part, name), 10) for name in ("torque", "measured")
    }, bounds=(0, 10 * search.part.rows))  # fmt: skip
    assert not room.noise_alone(replace(small, flt=often))


def test_random_moves_lead_on_from_a_wrong_minimum(
    search: Search, best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    """They go out from the lowest of what the other descents found, and may change all that is not fixed."""
    given: list[tuple[float, set[int], int]] = []

    def wander(
        one: Candidate, rows: ContactFilter, _: Box, free: set[int], long: Callable[[], bool], patience: int
    ) -> list[Candidate]:
        assert rows is search.part and not long()
        given.append((one.cost, free, patience))
        return [replace(best, start="moved", cost=one.cost - 1.0)]

    monkeypatch.setattr(
        "lostmotion.identification.prediction_error.contact_switching.search.descents.wandering", wander
    )
    for others in ("otherwise", "from_grid", "from_grid_of_three"):
        monkeypatch.setattr(Search, others, lambda *_: [])
    search = replace(search, fixed=("coulomb",))
    monkeypatch.setattr(room, "noise_alone", lambda _: True)
    search.rivals(best)
    assert given == []  # as if only the sensor's noise were left
    monkeypatch.setattr(room, "noise_alone", lambda _: False)
    monkeypatch.setattr(room, "KNOWN", -np.inf)
    found = search.rivals(best)
    (cost, free, patience), lowest = given[0], min(found, key=lambda one: one.cost)
    assert patience > PATIENCE_KNOWN
    assert lowest.start == "moved" and all(one.cost >= cost for one in found if one is not lowest)
    assert INDEX["coulomb"] not in free and {INDEX["backlash"], INDEX["share"], INDEX["share_fourth"]} <= free
    # Where the drive seems known, a few moves show whether it is.
    given.clear()
    monkeypatch.setattr(room, "KNOWN", np.inf)
    monkeypatch.setattr(room, "sharp", lambda _: True)
    search.rivals(best)
    assert given and all(patience == PATIENCE_KNOWN for *_, patience in given)


@pytest.mark.parametrize(
    ("inertias", "shafts", "share", "behind"),
    [((0.03, 0.02, 0.08), (lm.Shaft(2e4, 3.0), lm.Shaft(6e3, 1.0, backlash=0.01)), 0.4, False),
     ((0.05, 0.004, 0.076), (lm.Shaft(6e4, 3.0, backlash=0.01), lm.Shaft(6e3, 1.0)), 0.05, True)],
    ids=["heavy before the gap", "light behind it on a soft shaft"],
)  # fmt: skip
def test_a_gap_and_a_third_inertia_are_found_together(
    inertias: tuple[float, ...], shafts: tuple[lm.Shaft, ...], share: float, behind: bool
):
    """From two inertias of which only the motor's is right, without a gap. The light one is found only by descents that
    come down through the noise levels: at the sensor's alone they end at a cost of 0.77."""
    dt, count = 2e-4, 2.0 * np.pi / 2**20
    chain = lm.Drivetrain(inertias, shafts, (lm.Friction(), lm.Friction(), lm.Friction(1.0)))
    torque = lm.signals.excitation(1.0, dt, seed=3, inertia=0.13, coulomb=1.0, viscous=0.0)
    angle = np.floor(lm.simulate(chain, torque_motor=torque, dt=dt)["angle_motor"] / count) * count
    start = lm.Drivetrain.two_mass(
        inertia_motor=0.05, inertia_load=0.08, stiffness=3000.0, damping=1.0, backlash=0.0, coulomb=0.0
    )
    predictor = Predictor(torque, np.diff(angle, prepend=0.0) / dt, dt, True, start, skip=0)
    search = Search.of(ContactFilter.of(predictor, 300.0), start, start, (), None, (0.13, 0.05))
    best = min(search.from_grid_of_three([bare(search.raw("nameplate"))]), key=lambda one: one.cost)
    assert best.cost < 0.05 and best.flt.behind is behind
    for name, true in (("inertia_load", 0.08), ("backlash", 0.01), ("share", share)):
        assert best.values[name] == pytest.approx(true, rel=0.02), name


def test_a_third_inertia_from_the_start_on_where_two_lead_astray():
    """A drive of the zoo whose two inertias alone end far off, in a minimum that a third one does not leave."""
    drive = lm.rig.drive(3099)
    start, recording = drive.nameplate, drive.recording
    signals = (recording["torque_motor"], recording["speed_motor"], recording.dt)
    predictor = Predictor(*signals, recording.meta["speed_from_counts"], start, skip=0)
    flt, known = ContactFilter.of(predictor, 3.0 * start.pole_frequency), (start.inertia_total, 1.0)
    search = replace(Search.of(flt, start, start, (), None, known), part=flt.liveliest(3000))
    two = search.descent("nameplate")
    astray, right = (
        min(one.cost for one in search.thirds([two], raw)) for raw in ([], [search.raw("nameplate")])
    )
    assert right < 0.0 < 0.5 < astray


def test_further_inertias_are_tried_however_little_is_left(search: Search, best: Candidate):
    """One that is lacking may change the cost by no more than chance does, and values by more than their intervals."""
    thirds = search.thirds([replace(best, cost=1e-3)])
    assert thirds and all(Place.of(one) is not None for one in thirds)
    assert search.fourths([best]) == []
    fourths = search.fourths([replace(thirds[0], cost=-1.0), best])
    assert fourths and all(has_fourth(one) for one in fourths)
    assert search.fourths([replace(fourths[0], cost=-2.0), *thirds]) == []


def test_a_fit_with_a_third_inertia_is_freed_of_its_intervals(search: Search, best: Candidate):
    """Descents from elsewhere have none, and none of them led away from a backlash that was 8 % too small (5106). One
    that lacks a fourth, as on virtual rigs, is led away from right values."""
    search = replace(search, intermediate=(0.1, 0.1))
    wrong = replace(best, theta=best.flt.changed(best.theta, backlash=0.92 * best.values["backlash"]))
    [freed] = search.near(replace(wrong, cost=EXPLAINED - 0.01))[1]
    assert freed.values["backlash"] == pytest.approx(best.values["backlash"], rel=0.003)
    assert search.near(replace(wrong, cost=EXPLAINED + 0.01))[1] == []


def test_a_held_torque_is_told_from_one_that_goes_straight_from_row_to_row(search: Search, best: Candidate):
    """This recording's is a command: a ramp is no better, and from a ramp the search comes back to it."""
    assert with_other_torque(best, search.box) is None
    ramp = replace(best.flt, ramp=True)
    held = with_other_torque(replace(best, flt=ramp, cost=ramp.run(best.theta).cost), search.box)
    assert held is not None and not held.flt.ramp
    assert held.over(ramp).ramp is False


def test_the_search_ends_where_nothing_is_clearly_better_than_a_rigid_drive(
    search: Search, best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    """A spring fits some noise: it is always a little better."""

    class WentOn(Exception):
        pass

    def went_on(*_: object) -> list[Candidate]:
        raise WentOn

    def a_little_worse(_: Search, like: Candidate) -> Candidate:
        return replace(like, start="rigid", cost=like.cost + 5e-4)

    monkeypatch.setattr(Search, "is_the_drive", lambda *_: False)
    monkeypatch.setattr(Search, "otherwise", went_on)
    monkeypatch.setattr(Search, "rigid", a_little_worse)
    assert "nameplate" in {one.start for one in search.rivals(best)}
    # One that leaves more than the noise, or is clearly worse, is no reason to end.
    monkeypatch.setattr(Search, "rigid", lambda _, like: replace(like, cost=1.01 * room.KNOWN))
    with pytest.raises(WentOn):
        search.rivals(best)
    far = {"theta": search.begun["nameplate"], "cost": 0.9 * room.KNOWN}
    monkeypatch.setattr(Search, "rigid", lambda _, like: replace(like, **far))
    with pytest.raises(WentOn):
        search.rivals(best)


def test_a_rigid_drive_has_all_that_the_other_has_but_for_the_spring(plant: lm.Drivetrain):
    """Under an unknown load torque a rigid drive without one lost to any spring."""
    dt, count = 1e-3, 2.0 * np.pi / 2**16
    torque = lm.signals.excitation(4.0, dt, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    load = 2.0 * np.sin(3.0 * np.arange(torque.size) * dt)
    rigid = lm.Drivetrain(inertias=(0.1292,), frictions=(lm.Friction(viscous=0.0175, coulomb=2.0),))
    angle = lm.simulate(rigid, torque_motor=torque, torque_load=load, dt=dt)["angle_motor"]
    floor = count / np.sqrt(12.0)
    flt = ContactFilter(
        torque, np.floor(angle / count) * count, dt, True, floor, floor, 7, (0, torque.size), drifts=True
    )
    search = Search.of(flt, plant, plant, (), None, (0.1292, 0.05))
    search = replace(search, part=replace(flt, drifts=False))
    theta = search.begun["nameplate"]
    without, beside = (
        search.rigid(like)
        for like in (None, Candidate("any", theta, 1.0, flt, [INDEX["coulomb"], INDEX["rise"]]))
    )
    assert beside.flt.drifts and not without.flt.drifts
    assert beside.theta[INDEX["torque_rate"]] > -np.inf == without.theta[INDEX["torque_rate"]]
    assert beside.cost < 0.2 < without.cost - 0.2
