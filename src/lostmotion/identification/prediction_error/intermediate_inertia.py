"""An intermediate inertia on the shaft: the first thing that a real drivetrain has and two masses have not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..statistics.levenberg_marquardt import minimise
from .gain_schedule import ITERATIONS, Box, Stage
from .innovations import Bandwidth, Predictor

Array = NDArray[np.float64]

#: Where the search starts: the intermediate inertia's share of the motor's inertia, and the share of the shaft's
#: compliance before it (numerics).
SHARE, COMPLIANCE = 0.1, 0.5
#: The search keeps both within these bounds (numerics).
SMALLEST, LARGEST = 2e-3, 0.95
#: The intermediate inertia stays if the sum of squared innovations falls below this fraction (calibrated: on two
#: masses without any it falls by less than 1 %, on the virtual rigs 1 to 20 to a half or less).
WORTHWHILE = 0.9
#: The search ends when a step lowers the sum of squares by less than this fraction (numerics: along the valley of share
#: and compliance it would go on for long, and the parameters no longer move).
SMALLEST_GAIN = 1e-3


@dataclass(frozen=True, eq=False)
class JointPredictor(Predictor):
    """As ``Predictor``, with a part of the motor's inertia on the shaft.

    The parameters keep their meaning: the motor's inertia is all of it, stiffness and damping are those of the two
    masses with the same torsional mode. Share and compliance of it are no parameters; what is uncertain about
    them is taken out of the Jacobian, so that intervals hold for whichever fits best.

    Parameters
    ----------
    share, compliance : float
        The intermediate inertia's part of the motor's inertia; the part of the shaft's compliance before it.
    """

    share: float = SHARE
    compliance: float = COMPLIANCE

    @property
    def joint_piece(self) -> tuple[float, float] | None:
        return self.share, self.compliance

    @property
    def replicable(self) -> bool:
        """The replicas' drivetrain has no intermediate inertia."""
        return False

    def _innovations(self, thetas: Array, bandwidth: Bandwidth) -> Array:
        from ...kernels.innovations.intermediate_inertia import joint_innovations

        residual = joint_innovations(
            self._parameters(thetas),
            (self.share, self.compliance),
            (bandwidth.motor, bandwidth.load),
            self.dt,
            self.speed_from_counts,
            np.array(self.bounds, dtype=np.int64),
            self.torque,
            self.speed,
        )
        for settling in self.settling():
            residual[:, settling] = 0.0
        return np.asarray(residual)

    def jacobian(self, theta: Array, bandwidth: Bandwidth, free: list[int], residual: Array) -> Array:
        """(len(free), n) forward differences, without what share and compliance can make up for."""
        told, piece = self.both_jacobians(theta, bandwidth, free, residual)
        gram = np.einsum("ik,jk->ij", piece, piece)
        mixed = np.einsum("ik,jk->ij", told, piece)
        weights = np.linalg.lstsq(gram, mixed.T, rcond=1e-12)[0].T
        return np.asarray(told - np.einsum("ij,jk->ik", weights, piece))

    def both_jacobians(
        self, theta: Array, bandwidth: Bandwidth, free: list[int], residual: Array
    ) -> tuple[Array, Array]:
        """Of the parameters, (len(free), n), and of the logarithms of share and compliance, (2, n)."""
        step = 1e-4
        moved = np.log([self.share, self.compliance]) + step * np.eye(2)
        rows = self._pool.map(lambda both: self.with_piece(both).residual(theta, bandwidth), moved)
        piece = (np.array(list(rows)) - residual) / step
        return super().jacobian(theta, bandwidth, free, residual), piece

    def with_piece(self, logarithms: Array) -> JointPredictor:
        """A copy with the intermediate inertia of which the logarithms of share and compliance are given."""
        share, compliance = np.exp(logarithms)
        return replace(self, share=float(share), compliance=float(compliance))


def with_joint_piece(
    predictor: Predictor, stages: Sequence[Stage], box: Box
) -> tuple[Predictor, Stage] | None:
    """The fit with an intermediate inertia under the gain of the last stage; None if that predicts not clearly better.

    Parameters
    ----------
    stages : fits of two masses under ever lower gain
        From each of them a search starts, since no single one found the best minimum on all virtual rigs.
    """
    tried = []
    for first in range(len(stages)):
        joint, found = _joint(predictor), stages[first]
        for stage in stages[first:]:
            joint, found = _fit(joint, replace(found, bandwidth=stage.bandwidth), box)
        tried.append((joint, found))
    joint, found = min(tried, key=lambda one: one[1].fit.cost)
    return (joint, found) if found.fit.cost < WORTHWHILE * stages[-1].fit.cost else None


def _joint(predictor: Predictor) -> JointPredictor:
    return JointPredictor(
        predictor.torque, predictor.speed, predictor.dt, predictor.speed_from_counts, predictor.base, predictor.skip,
        predictor.bounds, predictor.skip_later, joined=predictor.joined,
    )  # fmt: skip


def _fit(joint: JointPredictor, stage: Stage, box: Box) -> tuple[JointPredictor, Stage]:
    """Parameters and intermediate inertia together, under the stage's gain."""
    n, bounds = stage.fit.theta.size, np.log([SMALLEST, LARGEST])

    def residual(both: Array) -> Array:
        return joint.with_piece(both[n:]).residual(both[:n], stage.bandwidth)

    def jacobian(both: Array, r: Array) -> Array:
        parts = joint.with_piece(both[n:]).both_jacobians(both[:n], stage.bandwidth, stage.free, r)
        return np.vstack(parts)

    found = minimise(
        residual, jacobian, np.append(stage.fit.theta, np.log([joint.share, joint.compliance])),
        [*stage.free, n, n + 1], np.append(box.lower, [bounds[0]] * 2), np.append(box.upper, [bounds[1]] * 2),
        ITERATIONS, SMALLEST_GAIN,
    )  # fmt: skip
    done = replace(found, theta=found.theta[:n])
    joint = joint.with_piece(found.theta[n:])
    return joint, replace(stage, fit=done, iterations=stage.iterations + found.iterations)
