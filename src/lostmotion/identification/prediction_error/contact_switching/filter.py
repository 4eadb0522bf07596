"""Innovations of the contact-switching filter over a recording, and the likelihood that they stand for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..innovations import Predictor
from .effort import Effort
from .parameter_vector import INDEX, KINDS, NAMES, PARAMETERS, units_of, values_of, vector_of
from .sensor.counting_rows import SETTLED, counting_rows, moves
from .sensor.noise import measured_with_noise
from .sensor.rounding import cost_as_gaussian, unlikelihood

Array = NDArray[np.float64]

#: Numbers of the contact laws in the kernel (layout).
LAWS = {"viscoelastic": 0, "dead_zone": 1, "clipped": 2, "limited": 3}

#: Finest pieces per torsional period, and halvings of a sample at most (numerics: an impact is placed to 0.2° of it).
FINEST, HALVINGS = 2000.0, 9
#: Slope of a load torque at the start, in standard deviations of the torque in a second (numerics: a period of 2 s).
DRIFT = 3.0
#: Sensors of the kernel (layout), and the variance over that of the first of one that weighs nothing (numerics).
SPEED_MOTOR, SPEED_LOAD, UNSEEN = 0, 1, 1e18


@dataclass(frozen=True, eq=False)
class Run:
    """One pass of the filter, over the n rows that count.

    Parameters
    ----------
    weighted : (n,) array
        Innovations over their standard deviations as the filter knows them. One entry more where the total inertia is
        beyond what the slow motion tells.
    cost : float
        Minus the logarithm of the likelihood per sample, concentrated over the size of the noise (charged: up to the
        level): 0 where the innovations are as large as the sensor's noise alone makes them, 0.1 where they are 10 %
        larger. Of rounding, on the same scale.
    gaussian : float
        The cost as if the noise were Gaussian: what Gauss–Newton steps lower.
    jacobian : (m, n) array
        Change of the weighted innovations with θ, one column for each of these, the gains as they are.
    rows : (n,) array
        Minus the logarithm of the likelihood of each row; their mean is the cost, but for that scale.
    deviations : (n,) array
        Standard deviations of the innovations as the filter knows them, over that of its noise.
    steps : int
        Steps of the model that it took, see ``effort``.
    """

    weighted: Array
    cost: float
    gaussian: float
    jacobian: Array
    rows: Array
    deviations: Array
    steps: int


@dataclass(frozen=True, eq=False)
class ContactFilter:
    """Motor torque and motor speed on one raster, in one or more pieces, and the law of the contact.

    Parameters
    ----------
    torque : (n,) array, Nm
    measured : (n,) array
        The motor's speed (rad/s), or its angle (rad) where the speed is a difference of counts.
    dt : float, s
    counted : bool
    floor : float
        Standard deviation of the sensor's noise, rad or rad/s.
    level : float
        The noise that the filter counts on, likewise: from far above the floor, where the cost is smooth, down to it.
    halvings : int
        A sample is halved so often at most.
    bounds : tuple of int
        First row of each piece, and the number of rows.
    settling : int
        Rows after the first motion of a piece that do not count: neither where in the gap it starts is known nor the
        torque of the load. The way to the first contact would be taken for half of the gap, and until then a wide gap
        predicts worse than none. Nor do counts at a standstill, see ``counting_rows``; with 0 all rows count.
    law : str
    ramp : bool
        Whether the torque goes straight from row to row, as a measured one does; else it is held.
    behind : bool
        Whether a third inertia is part of the load and sits behind the gap, else part of the motor and before it.
    fourth_behind : bool
        The same of a fourth inertia.
    drifts : bool
        Whether an unknown load torque is smooth: its slope changes at random, else itself.
    inertia : (float, float)
        Total inertia (kg m²) that the slow motion tells, and the half width of its logarithm; infinite: any.
    charged : bool
        Whether innovations larger than the filter thinks are charged. Else they are divided out: the cost of a filter
        that is lost is low and flat. That is no likelihood, but descents come through.
    rounded : bool
        Whether the noise is the rounding of counts: the likelihood is that of a uniform one, see ``sensor.rounding``.
    units : (float, float, float)
        Of torque (Nm), Coulomb (Nm) and viscous friction (Nm s/rad) in θ; the same for all parts of a recording.
    effort : Effort
        What all passes over all parts of a recording have taken.
    whole : ContactFilter, optional
        That of the whole recording, if this one is of a part of it.
    """

    torque: Array
    measured: Array
    dt: float
    counted: bool
    floor: float
    level: float
    halvings: int
    bounds: tuple[int, ...]
    settling: int = 0
    law: str = "viscoelastic"
    ramp: bool = False
    behind: bool = False
    fourth_behind: bool = False
    drifts: bool = False
    inertia: tuple[float, float] = (1.0, np.inf)
    charged: bool = True
    rounded: bool = False
    units: tuple[float, float, float] = (1.0, 1.0, 1.0)
    effort: Effort = field(default_factory=Effort)
    whole: ContactFilter | None = None

    @classmethod
    def of(cls, predictor: Predictor, pole: float) -> ContactFilter:
        """Of motor torque and speed, for poles up to about ``pole`` (Hz).

        Raises
        ------
        InvalidInput
            If the speed never changes.
        """
        dt = predictor.dt
        measured, floor, rounded = measured_with_noise(predictor)
        halvings = int(np.clip(np.ceil(np.log2(FINEST * pole * dt)), 0, HALVINGS))
        flt = cls(
            predictor.torque,
            np.ascontiguousarray(measured),
            dt,
            predictor.speed_from_counts,
            floor,
            floor,
            halvings,
            predictor.bounds,
            int(np.ceil(SETTLED / (pole * dt))),
        )
        return replace(flt, rounded=rounded, units=(flt.torque_size, flt.torque_size, flt.damper_size))

    @property
    def rows(self) -> int:
        return int(self.torque.size)

    @property
    def position_noise(self) -> float:
        """Standard deviation of the sensor's noise as an angle, rad; of a speed over one sample."""
        return self.floor if self.counted else self.floor * self.dt

    @cached_property
    def counting(self) -> NDArray[np.intp]:
        """Rows that count."""
        return counting_rows(self.measured, self.counted, self.floor, self.bounds, self.settling)

    @cached_property
    def _which(self) -> slice | NDArray[np.intp]:
        """The same; those of one piece follow each other and need not be gathered."""
        rows = self.counting
        return slice(int(rows[0]), int(rows[-1]) + 1) if rows[-1] - rows[0] + 1 == rows.size else rows

    @property
    def moves(self) -> bool:
        """Whether the motor moves at all."""
        return any(
            np.any(moves(self.measured[first:end], self.counted, self.floor))
            for first, end in pairwise(self.bounds)
        )

    def part(self, rows: slice) -> ContactFilter:
        """The same over some rows."""
        inner = [b - rows.start for b in self.bounds if rows.start < b < rows.stop]
        return replace(
            self,
            torque=np.ascontiguousarray(self.torque[rows]),
            measured=np.ascontiguousarray(self.measured[rows]),
            bounds=(0, *inner, rows.stop - rows.start),
            whole=self.whole or self,
        )

    def liveliest(self, rows: int) -> ContactFilter:
        """The part of so many rows in which torque and speed vary most."""
        if rows >= self.rows:
            return self
        starts = np.arange(0, self.rows - rows + 1, max(1, rows // 4))
        signals = (self.torque, np.gradient(self.measured) if self.counted else self.measured)
        spread = [np.array([np.std(s[i : i + rows]) for i in starts]) for s in signals]
        first = int(starts[np.argmax(sum(s / np.max(s) for s in spread))])
        return self.part(slice(first, first + rows))

    def run(self, theta: Array, free: Sequence[int] = ()) -> Run:
        """A pass with the parameters θ, and its sensitivities to the free ones."""
        q, counts = self.values(theta), self._which
        residuals, variances, jacobian, steps = self._pass(q, free, [SPEED_MOTOR])
        with np.errstate(all="ignore"):
            variance = variances[counts, 0]
            deviations = np.sqrt(variance)
            scale = 1.0 / (self.level * deviations)
            weighted = residuals[counts, 0] * scale
            size = min(float(np.mean(weighted**2)), 1.0 if self.charged else np.inf)
            over_floor = self.level / self.floor
            rows = 0.5 * (weighted**2 / size - 1.0 + np.log(size * variance * over_floor**2))
            cost = gaussian = float(np.mean(rows))
            if self.rounded and self.charged:
                rows = unlikelihood(weighted * deviations * over_floor, size * variance * over_floor**2)
                cost = cost_as_gaussian(float(np.mean(rows)))
            beyond, slope = self._beyond_slow_motion(q[INDEX["inertia_motor"]], q[INDEX["inertia_load"]])
            further = 0.5 * float(np.log1p(beyond**2))
        rows, cost, gaussian = rows + further, cost + further, gaussian + further
        jacobian = jacobian[:, counts, 0] * scale
        if beyond:
            weight = np.sqrt(rows.size * size)
            weighted = np.append(weighted, weight * beyond)
            last = weight * np.array([slope.get(NAMES[place], 0.0) for place in free])
            jacobian = np.column_stack([jacobian, last])
        cost, gaussian = (part if np.isfinite(part) else np.inf for part in (cost, gaussian))
        return Run(weighted, cost, gaussian, jacobian, rows, deviations, steps)

    def _pass(self, q: Array, free: Sequence[int], sensors: Sequence[int]) -> tuple[Array, Array, Array, int]:
        """Innovations (n, s), their variances (n, s) and changes (m, n, s) with the values q, and its steps; the first
        sensor is the motor's, the others weigh nothing and show zero."""
        from ....kernels.innovations.contact_switching import innovations

        m, n, count = len(free), self.rows, len(sensors)
        residuals, variances, jacobian = np.empty((n, count)), np.empty((n, count)), np.empty((m, n, count))
        measured = self.measured[:, None]
        if count > 1:
            measured = np.hstack([measured, np.zeros((n, count - 1))])
        with np.errstate(all="ignore"):
            twist = 0.5 * q[INDEX["backlash"]] + self.torque_deviation / q[INDEX["stiffness"]]
        torque = self.torque_deviation
        start = np.array([twist, 0.3 * self.speed_deviation, torque, torque * DRIFT]) / self.level
        parts = innovations(
            q, np.array(free, dtype=np.int64),
            np.array([KINDS[PARAMETERS[NAMES[i]]] for i in free], dtype=np.int64),
            self._units[list(free)],
            self.dt, LAWS[self.law], self.halvings, self.ramp, self.behind + 2 * self.fourth_behind, self.drifts,
            np.array(sensors, dtype=np.int64), self.counted, np.array([1.0, *[UNSEEN] * (count - 1)]),
            np.array(self.bounds, dtype=np.int64), self.torque, measured,
            self.level, tuple(np.maximum(start, 1.0)), residuals, variances, jacobian,
        )  # fmt: skip
        return residuals, variances, jacobian, self.effort.add(n, parts, m)

    def load_speed(self, theta: Array) -> Array:
        """(n,) speed of the load that the filter expects with the parameters θ, rad/s."""
        return -self._pass(self.values(theta), (), [SPEED_MOTOR, SPEED_LOAD])[0][:, 1]

    def _beyond_slow_motion(self, motor: float, load: float) -> tuple[float, dict[str, float]]:
        """How far the total inertia is beyond what the slow motion tells, in half widths, and its derivatives.

        An unknown load torque may stand for inertia in one-step predictions; in the slow motion it does not. One
        half width beyond weighs as much as all innovations together.
        """
        total, half = motor + load, self.inertia[1]
        with np.errstate(all="ignore"):
            away = float(np.log(total / self.inertia[0]))
        if not abs(away) > half:
            return 0.0, {}
        slope = {"inertia_motor": motor / total / half, "inertia_load": load / total / half}
        return (away - np.copysign(half, away)) / half, slope

    @cached_property
    def motor_speed(self) -> Array:
        """(n,) speed of the motor as recorded, rad/s; of counts a mean over some rows, and as many fewer."""
        if not self.counted:
            return self.measured
        return np.asarray(
            (self.measured[self._span :] - self.measured[: -self._span]) / (self._span * self.dt)
        )

    @property
    def motor_speed_noise(self) -> float:
        """Standard deviation of the sensor's noise in it, rad/s."""
        return np.sqrt(2.0) * self.floor / (self._span * self.dt) if self.counted else self.floor

    @property
    def _span(self) -> int:
        """Rows over which counts make a speed."""
        return max(1, min(20, self.rows // 10))

    @cached_property
    def torque_deviation(self) -> float:
        """Standard deviation of the motor torque, Nm."""
        return float(np.std(self.torque))

    @property
    def torque_size(self) -> float:
        """The same, never zero: what a torque is measured by."""
        return max(self.torque_deviation, 1e-300)

    @property
    def damper_size(self) -> float:
        """Torque over speed, Nm s/rad: what a viscous friction is measured by."""
        return self.torque_size / max(self.speed_deviation, 1e-300)

    @cached_property
    def speed_deviation(self) -> float:
        """Standard deviation of the motor speed, rad/s."""
        return float(np.std(self.motor_speed))

    def theta(self, values: Mapping[str, float]) -> Array:
        """Parameter vector of values, SI, zero where there is none; −inf for the logarithm of zero."""
        return vector_of(values, self.dt, self._units)

    def values(self, theta: Array) -> Array:
        """Values of a parameter vector, SI."""
        return values_of(theta, self.dt, self._units)

    def changed(self, theta: Array, **values: float) -> Array:
        """The parameter vector with other values, SI."""
        other, places = theta.copy(), [INDEX[name] for name in values]
        other[places] = self.theta(values)[places]
        return other

    @cached_property
    def _units(self) -> Array:
        return units_of(self.dt, *self.units)
