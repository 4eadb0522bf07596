"""Recording: named signals on one time axis, measured and simulated alike."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .argument_checks import checks_arguments, not_negative
from .display import numbers, tables
from .errors import InvalidInput
from .events import NO_EVENTS, Event, Events
from .plain_data import shown

#: Unit of every signal name that the package knows. An ending ``_estimated`` or ``_reference`` changes nothing.
SIGNAL_UNITS: Mapping[str, str] = MappingProxyType(
    {
        "torque_motor": "Nm",
        "torque_load": "Nm",
        "torque_shaft": "Nm",
        "angle_motor": "rad",
        "angle_load": "rad",
        "speed_motor": "rad/s",
        "speed_load": "rad/s",
        "speed_reference": "rad/s",
        "twist": "rad",
        "twist_elastic": "rad",
        "friction_load": "Nm",
        "energy_input": "J",
        "energy_stored": "J",
        "energy_dissipated": "J",
    }
)


#: Of the names that a chain numbers (``speed_2``) beside those above (``twist_1``).
NUMBERED_UNITS: Mapping[str, str] = MappingProxyType({"torque": "Nm", "speed": "rad/s"})


def unit_of(signal: str) -> str:
    """Unit of a signal by its name, "" where the name says nothing; a number at its end counts a chain's parts."""
    if signal in SIGNAL_UNITS:
        return SIGNAL_UNITS[signal]
    base = signal.removesuffix("_estimated").removesuffix("_reference")
    bare = re.sub(r"_\d+$", "", base)
    known = SIGNAL_UNITS if bare == base else {**NUMBERED_UNITS, **SIGNAL_UNITS}
    return known.get(bare, "")


def _disorder(time: NDArray[np.float64]) -> str:
    """What keeps the times from being those of a recording."""
    if time.ndim != 1 or time.size < 2:
        return f"shape {time.shape}"
    row = int(np.argmax(~(time[1:] > time[:-1])))
    return f"{time[row + 1]} s after {time[row]} s in row {row + 1}"


def _read_only(values: ArrayLike) -> NDArray[np.float64]:
    """The values as an array that cannot be written: copied, unless they are one already."""
    if isinstance(values, np.ndarray) and values.dtype == np.float64 and not _writable(values):
        return values
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


def _writable(array: NDArray[Any]) -> bool:
    """Whether anyone can write an array, by its own name or by that of the array that it is a part of."""
    return array.flags.writeable or (
        array.base is not None and not (isinstance(array.base, np.ndarray) and not _writable(array.base))
    )


@checks_arguments
@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """Signals on one time axis. Arrays are read-only; those that somebody could still write are copied.

    Parameters
    ----------
    time : (n,) array, s
        Strictly increasing.
    signals : mapping of name → (n,) array
        SI units, see ``SIGNAL_UNITS``. A torque is held from its row's time to the next; all else is sampled
        at the row's time.
    origin : mapping of name → {"measured", "simulated", "estimated", "derived", "reference"}
        Where each signal comes from; missing names count as "measured".
    events : Events
        Contact and friction changes (simulations only).
    final_state : mapping
        State after the last sample (simulations only), to go on from.
    meta : mapping
        Seed, file names, sensor data: anything that describes the recording.

    Raises
    ------
    InvalidInput
        If lengths differ or time does not increase.
    """

    time: NDArray[np.float64]
    signals: Mapping[str, NDArray[np.float64]]
    origin: Mapping[str, str] = field(default_factory=dict)
    events: Events = NO_EVENTS
    final_state: Mapping[str, Any] = field(default_factory=dict)
    meta: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        time = _read_only(self.time)
        if time.ndim != 1 or time.size < 2 or not np.all(time[1:] > time[:-1]):
            raise InvalidInput(
                "Recording.time",
                _disorder(time),
                "at least two strictly increasing times",
                "Sort or crop it.",
            )
        signals = {name: _read_only(values) for name, values in self.signals.items()}
        for name, values in signals.items():
            if values.shape != time.shape:
                raise InvalidInput(
                    f"Recording signal {name!r}",
                    f"shape {values.shape}",
                    f"one value for each of the {time.size} times",
                    "Resample it to the common time axis.",
                )
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "signals", MappingProxyType(signals))
        for name in ("origin", "final_state", "meta"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        object.__setattr__(self, "events", Events.of(self.events))

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        try:
            return self.signals[name]
        except (KeyError, TypeError):  # a slice, a number: a recording is not cut by them
            raise InvalidInput(
                f"Recording[{shown(name)}]",
                "no such signal",
                f"one of {sorted(self.signals)}",
                "Check the name.",
            ) from None

    def __contains__(self, name: object) -> bool:
        return name in self.signals

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    def __len__(self) -> int:
        return int(self.time.size)

    def __repr__(self) -> str:
        by_origin: dict[str, list[str]] = {}
        for name in self:
            unit = unit_of(name)
            by_origin.setdefault(self._origin(name), []).append(f"{name} ({unit})" if unit else name)
        shown = [
            tables.listing([f"{origin}: {names[0]}", *names[1:]], later="    ")
            for origin, names in by_origin.items()
        ]
        return "\n".join([self._title(), *shown])

    def _repr_html_(self) -> str:
        rows = []
        for name, values in self.signals.items():
            ends = (numbers.digits(float(end)) for end in (np.fmin.reduce(values), np.fmax.reduce(values)))
            rows.append((name, unit_of(name), self._origin(name), *ends))
        return tables.html(self._title(), ("signal", "unit", "origin", "smallest", "largest"), rows)

    def _title(self) -> str:
        step, duration = (numbers.given(float(t), "s") for t in (self.dt, self.time[-1] - self.time[0]))
        count = f", {len(self.events)} events" if self.events else ""
        return tables.plain(f"Recording: {len(self)} samples of {step}, {duration}{count}")

    def _origin(self, name: str) -> str:
        return self.origin.get(name, "measured")

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.signals)

    @property
    def dt(self) -> float:
        """Sample time in s: the mean step."""
        return float((self.time[-1] - self.time[0]) / (self.time.size - 1))

    @checks_arguments
    def impacts(self, merge: float = 2e-3) -> tuple[Event, ...]:
        """The impacts; those at one place that follow each other within `merge` seconds count as one.

        A merged impact has the time of its first bounce, the largest speed, and the sum of the energies. The default,
        2 ms, is chosen: about a fifth of a period of the paper's eigenmode at 100 Hz.
        """
        not_negative("Recording.impacts.merge", merge)
        merged: list[Event] = []
        latest: dict[str, tuple[int, float]] = {}
        for event in self.events.of_kind("impact"):
            index, before = latest.get(event.place, (-1, -np.inf))
            if event.time - before < merge:
                first = merged[index]
                speed = max(first.speed, event.speed, key=abs)
                merged[index] = first._replace(speed=speed, energy=first.energy + event.energy)
            else:
                index = len(merged)
                merged.append(event)
            latest[event.place] = (index, event.time)
        return tuple(merged)

    def energy(self) -> Mapping[str, NDArray[np.float64]]:
        """Energies since the first row, J, (n,) each: ``input``, ``stored``, ``dissipated``, and their ``balance``.

        Made by ``simulate(..., energy=True)``. Each is integrated on its own; balance = input − change of stored −
        dissipated shows how exactly.
        """
        if "energy_input" not in self.signals:
            raise InvalidInput(
                "Recording.energy",
                "a recording without energies",
                "one of simulate(…, energy=True)",
                "Simulate with it.",
            )
        given, stored, lost = (self[f"energy_{name}"] for name in ("input", "stored", "dissipated"))
        balance = given - (stored - stored[0]) - lost
        return MappingProxyType({"input": given, "stored": stored, "dissipated": lost, "balance": balance})

    @checks_arguments
    def window(self, start: float = -np.inf, stop: float = np.inf) -> Recording:
        """The rows with start ≤ time < stop (s), within a millionth of a sample for rounding."""
        slack = 1e-6 * self.dt
        keep = (self.time >= start - slack) & (self.time < stop - slack)
        if np.count_nonzero(keep) < 2:
            raise InvalidInput(
                "Recording.window",
                f"[{start}, {stop}) s",
                f"at least two samples between {self.time[0]:g} and {self.time[-1]:g} s",
                "Choose a window inside the recording.",
            )
        events = self.events
        return replace(
            self,
            time=self.time[keep],
            signals={name: values[keep] for name, values in self.signals.items()},
            events=events.only((events.time >= start) & (events.time < stop)),
            final_state={},
        )

    def with_signals(self, origin: str, /, **signals: ArrayLike) -> Recording:
        """A copy with signals added or replaced, all of the given origin."""
        return replace(
            self,
            signals={**self.signals, **{n: np.asarray(v, dtype=float) for n, v in signals.items()}},
            origin={**self.origin, **dict.fromkeys(signals, origin)},
        )

    def only(self, *names: str) -> Recording:
        """A copy with the named signals alone: what is withheld from an estimator is not in its recording.

        Of ``meta`` stays what says how these signals were sampled: ``speed_from_counts``, ``averaged``, and what stands
        there under their own names. Seeds, files and laws, from which the rest could be made again, do not.
        """
        meta = {key: value for key, value in self.meta.items() if key in (*names, "speed_from_counts")}
        if "averaged" in self.meta:
            meta["averaged"] = tuple(name for name in self.meta["averaged"] if name in names)
        return replace(
            self,
            signals={name: self[name] for name in names},
            origin={n: o for n, o in self.origin.items() if n in names},
            events=NO_EVENTS,
            final_state={},
            meta=meta,
        )
