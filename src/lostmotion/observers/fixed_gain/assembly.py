"""An observer in Lur'e form from its model and gain: curves of gap and friction, and the rows that use them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...curves import PiecewiseLinear, dead_zone, saturation
from ...drivetrain import Friction
from ...systems import DiscreteSystem
from ..estimates import estimated
from ..model import ObserverModel
from .gates import with_gates, with_innovation
from .injection import Injection
from .input_checks import with_checks, with_torque_check

Array = NDArray[np.float64]


def _coulomb_curve(friction: Friction, speed_per_torque: float) -> PiecewiseLinear:
    """Torque that brings the speed z to rest within the sample, limited to the Coulomb levels."""
    plus, minus = friction.coulomb_plus, friction.coulomb_minus
    return PiecewiseLinear(((-minus * speed_per_torque, -minus), (plus * speed_per_torque, plus)))


class _Argument(NamedTuple):
    """Of a curve: rows over the states, the torque's factor, those of other curves, a row over the measured signals."""

    states: Array
    torque: float
    curves: Mapping[str, float]
    measured: Array


class Assembly:
    """Collects states, curves and rows of the observer, then makes the DiscreteSystem.

    Columns of Γ: torque, gap, motor friction, load friction.
    """

    def __init__(self, model: ObserverModel, phi: Array, gamma: Array, dt: float) -> None:
        self.model = model
        self.dt = dt
        self.phi = phi
        self.gamma = gamma
        self.curves: dict[str, PiecewiseLinear] = {}
        self.arguments: dict[str, _Argument] = {}
        self.slack_gain: Array | None = None
        self.extra: dict[str, Array] = {}
        self._add_gap()
        self._add_friction()

    def add_state(self, name: str, row: Array) -> None:
        """Add a state whose next value is a row over the model's states."""
        self.extra[name] = row

    def close_in_gap(self, gain: Array) -> None:
        """Correct with this gain while the estimate is inside the gap, with the usual one in contact only."""
        if self.model.drivetrain.shaft.has_backlash:
            self.slack_gain = gain

    def inject(self, injection: Injection, measured: tuple[str, ...]) -> None:
        """Let the gap that drives the state, and that of the expected shaft torque, see the sensors too.

        Outputs and checks keep the gap of the estimate alone: it has no noise, and needs no sample that may be missing.
        """
        seeing = ["gap"]
        if "torque_shaft" in measured:
            half = 0.5 * self.model.drivetrain.shaft.backlash
            self._add_curve("gap_measured", saturation(half), self.model.contact_argument())
            seeing.append("gap_measured")
        for name in seeing:
            argument = self.arguments[name]
            row = injection.states.copy()
            row[: argument.states.size] += argument.states
            self.arguments[name] = argument._replace(states=row, measured=injection.measured)
        # What predicts a measured signal comes before what reads it.
        self.curves = {"torque": self.curves["torque"], **self.curves}
        self.arguments = {name: self.arguments[name] for name in self.curves}

    def _add_curve(
        self,
        name: str,
        curve: PiecewiseLinear,
        row: Array,
        torque: float = 0.0,
        curves: dict[str, float] | None = None,
    ) -> None:
        self.curves[name] = curve
        self.arguments[name] = _Argument(row, torque, curves or {}, np.zeros(0))

    def _add_gap(self) -> None:
        model, shaft = self.model, self.model.drivetrain.shaft
        if not shaft.has_backlash:
            return
        half = 0.5 * shaft.backlash
        # The gap acts on the state over the whole sample, so it is evaluated at mid-sample; the outputs belong to
        # the sample's start.
        self._add_curve("gap", saturation(half), model.contact_argument(ahead=0.5 * self.dt))
        self._add_curve("torque", dead_zone(half), model.contact_argument())
        if shaft.contact != "dead_zone" and shaft.damping > 0.0:
            self._add_curve("elastic", dead_zone(half), model.row(twist=1.0))

    def _add_friction(self) -> None:
        for column, place in ((2, "motor"), (3, "load")):
            friction = self.model.drivetrain.frictions[column - 2]
            if max(friction.coulomb_plus, friction.coulomb_minus) > 0.0:
                i = self.model.states.index(f"speed_{place}")
                others = {
                    name: self.gamma[i, j] for name, j in (("gap", 1), ("motor", 2)) if name in self.curves
                }
                curve = _coulomb_curve(friction, abs(float(self.gamma[i, column])))
                self._add_curve(place, curve, self.phi[i], float(self.gamma[i, 0]), others)

    def system(
        self,
        measured: tuple[str, ...],
        gain: Array,
        c: Array,
        name: str = "kalman",
        innovation: bool = False,
        limits: Mapping[str, float] | None = None,
    ) -> DiscreteSystem:
        """The observer with gain and measurement rows c, both over the model's states and the memory.

        With ``innovation``, measured minus expected value of each sensor are further outputs. With ``limits`` (see
        ``with_checks``; may be empty) the measured inputs are checked.
        """
        names = tuple(self.curves)
        n, n_w = len(self.model.states), len(names)
        n_known = gain.shape[0]
        phi = np.zeros((n_known, n_known))
        phi[:n, :n] = self.phi
        for i, row in enumerate(self.extra.values()):
            phi[n + i, :n] = row
        e = np.zeros((n_known, n_w))
        for curve, column in (("gap", 1), ("motor", 2), ("load", 3)):
            if curve in names:
                e[:n, names.index(curve)] = self.gamma[:, column]
        c_x, c_w = self._corrected_by(measured, c, names)
        always = gain if self.slack_gain is None else self.slack_gain
        b = np.hstack([np.pad(self.gamma[:, [0]], ((0, n_known - n), (0, 0))), always])
        a, e = phi - always @ c_x, e - always @ c_w
        states = (*self.model.states, *self.extra)
        if "load" in names:
            # The friction output is that of the last sample, a state: this sample's would need this sample's torque,
            # which a controller may compute from it.
            states = (*states, "coulomb_load")
            a = np.pad(a, ((0, 1), (0, 1)))
            b = np.pad(b, ((0, 1), (0, 0)))
            e = np.vstack([e, np.eye(1, n_w, names.index("load"))])
        f, g, h = self._argument_matrices(names, len(states), b.shape[1])
        outputs, c_out, j_out = self._outputs(measured, states, names)
        law = DiscreteSystem(
            inputs=("torque_motor", *measured), outputs=outputs, states=states, dt=self.dt, name=name,
            curves=tuple(self.curves.values()), A=a, B=b, E=e, F=f, G=g, H=h, C=c_out, J=j_out,
        )  # fmt: skip
        further = ((0, 0), (0, len(states) - n_known))
        residual = np.pad(c_x, further), c_w
        if self.slack_gain is not None:
            law = with_gates(law, measured, residual, gain - self.slack_gain, self.model)
        if limits is not None:
            c_x, c_w = self._measurement(measured, c, names)
            predicted = np.pad(c_x, further), c_w
            law = with_checks(law, measured, predicted, self.model.drivetrain, limits)
            if "speed_motor" in measured:
                law = with_torque_check(law, self.model.drivetrain)
        return with_innovation(law, measured, residual) if innovation else law

    def _measurement(
        self, measured: tuple[str, ...], c: Array, names: tuple[str, ...]
    ) -> tuple[Array, Array]:
        """ŷ = c_x x + c_w w: the rows with the gap closed, but the shaft torque through its gap curve."""
        c_x, c_w = c.copy(), np.zeros((len(measured), len(names)))
        if "torque_shaft" in measured and "torque" in names:
            i = measured.index("torque_shaft")
            c_x[i, : len(self.model.states)], c_w[i] = self._torque_rows(names)
        return c_x, c_w

    def _corrected_by(
        self, measured: tuple[str, ...], c: Array, names: tuple[str, ...]
    ) -> tuple[Array, Array]:
        """ŷ of the correction: with an injection, the shaft torque is that of the gap which sees the sensors."""
        if "gap_measured" not in names:
            return self._measurement(measured, c, names)
        c_w = np.zeros((len(measured), len(names)))
        c_w[measured.index("torque_shaft"), names.index("gap_measured")] = -self.model.drivetrain.stiffness
        return c, c_w

    def _torque_rows(self, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Shaft torque as rows over the model's states and the curves."""
        model, shaft, w = self.model, self.model.drivetrain.shaft, np.zeros(len(names))
        if "torque" not in names:
            return model.measurement_row("torque_shaft"), w
        w[names.index("torque")] = shaft.stiffness
        damping = shaft.damping if shaft.contact == "dead_zone" else 0.0
        return model.row(speed_motor=damping, speed_load=-damping), w

    def _argument_matrices(self, names: tuple[str, ...], n_x: int, n_u: int) -> tuple[Array, Array, Array]:
        f, g, h = np.zeros((len(names), n_x)), np.zeros((len(names), n_u)), np.zeros((len(names), len(names)))
        for i, argument in enumerate(self.arguments.values()):
            f[i, : argument.states.size] = argument.states
            g[i, 0] = argument.torque
            g[i, 1 : 1 + argument.measured.size] = argument.measured
            for name, value in argument.curves.items():
                h[i, names.index(name)] = value
        return f, g, h

    def _outputs(
        self, measured: tuple[str, ...], states: tuple[str, ...], names: tuple[str, ...]
    ) -> tuple[tuple[str, ...], Array, Array]:
        model, no_curve = self.model, np.zeros(len(names))
        elastic = "elastic" if "elastic" in names else "torque"
        in_gap = elastic in names
        friction = model.row(speed_load=model.drivetrain.viscous)
        rows: dict[str, tuple[Array, Array]] = {
            "twist": (model.row(twist=1.0), no_curve),
            "twist_elastic": (
                model.row(twist=0.0 if in_gap else 1.0),
                np.eye(1, len(names), names.index(elastic))[0] if in_gap else no_curve,
            ),
            "speed_motor": (model.row(speed_motor=1.0), no_curve),
            "speed_load": (model.row(speed_load=1.0), no_curve),
            "torque_shaft": self._torque_rows(names),
            "friction_load": (friction, no_curve),
        }
        if "angle_motor" in measured:
            rows["angle_motor"] = (model.row(angle_motor=1.0), no_curve)
        if "torque_load" in model.states:
            rows["torque_load"] = (model.row(torque_load=1.0), no_curve)
        c = np.zeros((len(rows), len(states)))
        c[:, : len(model.states)] = [row for row, _ in rows.values()]
        if "coulomb_load" in states:
            c[list(rows).index("friction_load"), states.index("coulomb_load")] = 1.0
        return estimated(*rows), c, np.array([w for _, w in rows.values()])
