"""What is done with a sample of a sensor: the words that filters and laws with a fixed gain share.

A sample that is missing, frozen or a jump is not used: its prediction takes its place, so the estimate goes on as the
model says, and it is flagged. After a hold time of such samples the signal counts as right and the estimate as wrong.

Each of the two has a rule of its own, since they know different things. An estimator knows how sure it is and how
noisy its sensor: ``estimators.sensor_check`` compares the innovation with its own deviation. A law with a fixed gain
knows neither: ``law.input_check`` compares the error with recent errors. Each rule was tried in place of the other
(virtual rigs 5 to 10, faults of ``benchmarks/observers.py``, 2026-11-22):

- the law's rule in the filters: 50 ms after a frozen speed the worst rig has 5.0 instead of 1.8 times the normal error
  with ``extended_kalman``, 93 instead of 97 % of frozen samples are flagged, and after a jump of 5 rad/s the sliding
  mode has 4.2 (worst 25) instead of 1.1 (1.2) times;
- the filters' rule in the laws: ``kalman`` flags 0.15 to 0.5 % of good samples instead of none, and has 33 (47) instead
  of 24 (27) times the normal error after all inputs were missing.
"""

from __future__ import annotations

#: Use the sample. Start again from it: it is used, and flagged. It is missing, frozen, a jump: predict through it.
USE, START_AGAIN, MISSING, FROZEN, JUMP = 0, 1, 2, 3, 4

#: Numerics: an input outside ±INPUT_BOUND (NaN and infinity included) is missing. Far above any physical value, and far
#: enough below the largest single-precision number (3.4e38) to multiply it by a gain.
INPUT_BOUND = 1e30
