"""Other fits of the same model: they agree where it is right, and show where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.estimate import CORE, TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.intervals import refits
from lostmotion.identification.prediction_error.contact_switching.intervals.refits import disagreement
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX


def fitted(flt: ContactFilter, values: dict[str, float]) -> tuple[Candidate, Box]:
    theta = flt.theta(values)
    box = Box.around(flt, theta, 10.0)
    return polish(Candidate("truth", theta, 0.0, flt, sorted(INDEX[name] for name in TOLD)), flt, box), box


def test_where_the_model_is_right_the_other_fits_agree(flt: ContactFilter, values: dict[str, float]):
    best, box = fitted(flt.liveliest(4000), values)
    assert np.max(disagreement(best, [], box)[CORE]) < 0.01


def test_a_torque_that_is_wrong_in_one_half_shows(flt: ContactFilter, values: dict[str, float]):
    part = flt.liveliest(4000)
    factor = np.where(np.arange(part.rows) < part.rows // 2, 1.2, 1.0)
    best, box = fitted(replace(part, torque=factor * part.torque), values)
    apart = disagreement(best, [], box)
    assert apart[TOLD.index("stiffness")] > 0.03


@pytest.mark.parametrize("parts", [{"rise": 0.1, "fade": 1.0}, {"coulomb_motor": 1.0}], ids=["rise", "motor"])
def test_a_half_at_a_standstill_tells_nothing(
    flt: ContactFilter, values: dict[str, float], parts: dict[str, float]
):
    part = flt.liveliest(3000)
    noise = 0.0 if part.counted else 0.01 * np.random.default_rng(5).standard_normal(part.rows)
    still = np.full(part.rows, part.measured[0] if part.counted else 0.0) + noise
    measured = np.concatenate([still, part.measured])
    waited = replace(
        part,
        torque=np.concatenate([np.zeros(part.rows), part.torque]),
        measured=measured,
        bounds=(0, measured.size),
    )
    assert waited.moves and not waited.part(slice(0, part.rows)).moves
    best, box = fitted(waited, values | parts)
    assert np.max(disagreement(best, [], box)[CORE]) < (0.01 if "rise" in parts else 0.1)


def test_a_fit_with_more_noise_counts_as_far_as_it_tells_a_value(
    flt: ContactFilter, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    best, box = fitted(flt.liveliest(3000), values)
    place = TOLD.index("backlash")

    def beyond(part: float) -> float:
        def told(one: Candidate, *_: object) -> tuple[np.ndarray, np.ndarray]:
            more_noise = one.flt.rows == best.flt.rows
            return np.full(8, 0.3 if more_noise else 0.0), np.full(8, part)

        monkeypatch.setattr(refits, "_beyond_chance", told)
        return float(disagreement(best, [], box)[place])

    assert beyond(1.0) == pytest.approx(0.3)
    assert beyond(0.01) == pytest.approx(0.003)


def test_a_law_counts_as_far_as_the_recording_is_not_explained(flt: ContactFilter, values: dict[str, float]):
    best, box = fitted(flt.liveliest(4000), values)
    best = replace(best, cost=0.5)
    theta = best.theta.copy()
    theta[INDEX["backlash"]] += 0.2
    near, far = (replace(best, theta=theta, cost=cost) for cost in (0.9, 1.1))
    place = TOLD.index("backlash")
    assert disagreement(best, [near], box)[place] == pytest.approx(0.2)
    assert disagreement(best, [far], box)[place] < 0.01


def test_rows_that_tell_little_of_a_value_shift_it_little(
    flt: ContactFilter, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    """A fit of rows that know the backlash ten times worse may be 0.2 off: the fit of all rows hardly heard them."""
    best, _ = fitted(flt.liveliest(4000), values)
    theta, place = best.theta.copy(), TOLD.index("backlash")
    theta[INDEX["backlash"]] += 0.2
    away = replace(best, theta=theta)

    def shift(error: float) -> tuple[float, float]:
        monkeypatch.setattr(refits, "scatter", lambda one: (np.eye(8), np.full(8, error)))
        found, part = refits._beyond_chance(away, best, np.full(8, 0.001))
        return float(found[place]), float(part[place])

    assert shift(0.0014) == pytest.approx((0.2, 0.5), rel=0.03)
    assert shift(0.01) == pytest.approx((0.2, 0.01), rel=0.01)
    assert shift(0.2) == (0.0, 0.0)
    assert shift(0.0009) == pytest.approx((0.2, 1.0))
