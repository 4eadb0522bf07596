"""What the observers with one sensor, the motor speed, share: start, innovation, correction, prediction, outputs."""

from __future__ import annotations

from ...jit import njit
from ..layout import ANGLE_COUNTED, SPEED_LOAD, SPEED_MOTOR, TORQUE_ACTUATOR, TWIST
from ..missing_inputs import torque_to_use
from ..sensor_check import LOST, check_sample
from ..sensors import deviation_of_counts
from ..two_mass_model import advance, clip, gap_argument, write_estimates
from ..verdicts import FROZEN, START_AGAIN, USE

#: Each sample that is there again makes up for so many in which torque and speed were missing. Calibration: virtual
#: rigs 1 to 4.
FADE = 0.25
#: Shares of the hold time: what is less does no harm; while more is left, the side of the gap is not known.
#: Calibration: virtual rigs 1 to 4.
SHORT, UNSURE = 0.1, 0.33


@njit(cache=True, inline="always")
def restart(p, s, speed):
    """Both inertias at ``speed``, in the middle of the gap."""
    x = s.x
    x[TWIST] = p.x0[TWIST]
    x[SPEED_MOTOR] = x[SPEED_LOAD] = speed
    x[TORQUE_ACTUATOR] = s.torque
    x[ANGLE_COUNTED] = speed * p.dt
    s.friction = s.moved = s.unused = s.given = s.blind = 0.0
    s.started = 1.0


@njit(cache=True, inline="always")
def innovation_of(own, s, inputs, faults):
    """Torque to use, innovation (0 where the speed is not used), faults.

    What the samples of a value that turns out to be frozen have done to the motor speed is taken back. A speed from
    counts moves the angle counted on, so that the angle is measured from the newest count.
    """
    p, x = own.common, s.x
    torque, faults = torque_to_use(p, s, inputs[0], faults)
    speed = inputs[1]
    missing = faults & 2 != 0
    if s.started == 0.0:
        restart(p, s, 0.0 if missing else speed)
    innovation = speed - (x[ANGLE_COUNTED] / p.dt if p.counted else x[SPEED_MOTOR])
    verdict = check_sample(p, 0, s.sensor, speed, missing, s.moved, innovation, _expected(own, s) ** 2)
    if verdict == START_AGAIN:
        restart(p, s, speed)
    if verdict == FROZEN:
        x[SPEED_MOTOR] -= s.given
        s.given = 0.0
    if verdict != USE:
        s.blind = min(s.blind + float(faults & 1), p.hold)
        s.unused = min(s.unused + 1.0, p.hold)
        x[ANGLE_COUNTED] = 0.0
        return torque, 0.0, faults | 2
    first_used, s.unused = s.unused > 0.0, 0.0
    x[ANGLE_COUNTED] -= speed * p.dt
    s.blind = max(s.blind - FADE, 0.0)
    if faults & 1 or (first_used and s.blind > SHORT * p.hold):
        # Without a motor torque, and for what it did unseen, the motor's speed is the measured one. That is no error of
        # the model's and tells nothing of the load: nothing else is corrected.
        x[SPEED_MOTOR] += innovation
        x[ANGLE_COUNTED] += innovation * p.dt
        return torque, 0.0, faults
    return torque, innovation, faults


@njit(cache=True, inline="always")
def _expected(own, s):
    """Largest innovation that is expected, over the gate."""
    p = own.common
    expected = own.expected + own.growth * s.unused
    expected += p.torque_missing * p.dt * s.blind / p.gate
    return expected + own.coarser * max(deviation_of_counts(s.sensor) - own.noise, 0.0)


@njit(cache=True, inline="always")
def write(own, s, outputs):
    """The six outputs that every observer has."""
    write_estimates(own.common, s.x, own.half_gap, s.friction, outputs)


@njit(cache=True, inline="always")
def load_slips(own, s):
    """Whether the load's friction is at its level."""
    p = own.common
    return abs(s.friction) >= own.coulomb * min(p.ratio_plus, p.ratio_minus)


@njit(cache=True, inline="always")
def correct(own, s, angle, twist, motor, load):
    """The corrections; those of twist and load only where the motor can feel them.

    In the gap the motor speed contains nothing of them, and a load that sticks needs none. Both act while it is not
    known whether the joint is in the gap, after all inputs were missing.
    """
    p, x = own.common, s.x
    if s.blind > UNSURE * p.hold or abs(gap_argument(x, p.lead_middle)) > own.half_gap:
        x[TWIST] += twist
        if load_slips(own, s):
            x[SPEED_LOAD] += load
    x[SPEED_MOTOR] += motor
    s.given = motor if s.sensor.repeats == 1.0 else s.given + motor
    x[ANGLE_COUNTED] += angle


@njit(cache=True, inline="always")
def predict(own, s, torque):
    """One sample of the model, in substeps; returns whether the estimate was lost and starts again."""
    p, x = own.common, s.x
    before, friction = x[SPEED_MOTOR], 0.0
    for _ in range(int(p.substeps)):
        gap = clip(gap_argument(x, p.lead_middle), -own.half_gap, own.half_gap)
        n0, n1, n2, n3, turn, _, friction = advance(p, x, 0.0, own.coulomb, gap, torque)
        x[TWIST], x[SPEED_MOTOR], x[SPEED_LOAD], x[TORQUE_ACTUATOR] = n0, n1, n2, n3
        x[ANGLE_COUNTED] += turn
    s.moved, s.friction = x[SPEED_MOTOR] - before, friction
    return start_again_if_lost(p, s)


@njit(cache=True, inline="always")
def start_again_if_lost(p, s):
    """Start again at standstill if the estimate is no number of this drivetrain; returns whether."""
    x = s.x
    if (
        abs(x[TWIST]) < LOST
        and abs(x[SPEED_MOTOR]) < LOST
        and abs(x[SPEED_LOAD]) < LOST
        and abs(x[TORQUE_ACTUATOR]) < LOST
    ):
        return False
    restart(p, s, 0.0)
    s.started = 0.0
    return True
