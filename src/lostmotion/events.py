"""Contact and friction changes of a simulation: kept as columns, made into objects when looked at."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput
from .plain_data import shown

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: Kinds of events, in the order of their numbers.
KINDS = ("impact", "separation", "stick", "slip")


def _number_of(kind: str) -> int:
    """Place of a kind in ``KINDS``."""
    if kind not in KINDS:
        raise InvalidInput("Event.kind", shown(kind), f"one of {', '.join(KINDS)}", "Correct it.")
    return KINDS.index(kind)


class Event(NamedTuple):
    """One change of contact or friction state.

    Parameters
    ----------
    time : float, s
    kind : {"impact", "separation", "stick", "slip"}
    place : str
        ``shaft 1`` … or ``friction 1`` …, counted from the motor.
    speed : float, rad/s
        Of a shaft the rate of its twist, of a friction the speed of its inertia.
    energy : float, J
        Of an impact: ½·J·speed² with J = J₁J₂/(J₁ + J₂) of the inertias at the shaft's ends; else 0.
    """

    time: float
    kind: str
    place: str
    speed: float
    energy: float = 0.0


class Events(Sequence[Event]):
    """A sequence of ``Event`` in the order of time, equal to a tuple of them; its columns are arrays.

    Parameters
    ----------
    time : (n,) array, s
    kind : (n,) array of int
        Places in ``KINDS``.
    place : (n,) array of int
        Places in `places`.
    speed : (n,) array, rad/s
    energy : (n,) array, J
    places : tuple of str
    """

    def __init__(
        self,
        time: Array,
        kind: Indices,
        place: Indices,
        speed: Array,
        energy: Array,
        places: tuple[str, ...],
    ) -> None:
        self.time, self.kind, self.place, self.speed, self.energy = time, kind, place, speed, energy
        self.places = places
        for column in (time, kind, place, speed, energy):
            column.setflags(write=False)

    @classmethod
    def of(cls, events: Iterable[Event]) -> Events:
        """The same events as columns; raises ``InvalidInput`` where one is of an unknown kind."""
        if isinstance(events, Events):
            return events
        rows = tuple(events) if isinstance(events, Iterable) else (events,)
        if not all(isinstance(row, Event) for row in rows):
            raise InvalidInput("events", shown(events), "a sequence of Event", "Give () for none.")
        places = tuple(dict.fromkeys(event.place for event in rows))
        return cls(
            np.array([event.time for event in rows], dtype=float),
            np.array([_number_of(event.kind) for event in rows], dtype=np.int64),
            np.array([places.index(event.place) for event in rows], dtype=np.int64),
            np.array([event.speed for event in rows], dtype=float),
            np.array([event.energy for event in rows], dtype=float),
            places,
        )

    def only(self, which: NDArray[np.bool_] | slice | Indices) -> Events:
        """The events that a mask, a slice or numbers choose."""
        return Events(
            self.time[which],
            self.kind[which],
            self.place[which],
            self.speed[which],
            self.energy[which],
            self.places,
        )

    def of_kind(self, kind: str) -> Events:
        """The events of one kind."""
        return self.only(self.kind == _number_of(kind))

    def count_of(self, kind: str) -> int:
        """How many events of one kind there are."""
        return int(np.count_nonzero(self.kind == _number_of(kind)))

    def __len__(self) -> int:
        return int(self.time.size)

    @overload
    def __getitem__(self, index: int) -> Event: ...
    @overload
    def __getitem__(self, index: slice) -> Events: ...
    def __getitem__(self, index: int | slice) -> Event | Events:
        if isinstance(index, slice):
            return self.only(index)
        return Event(
            float(self.time[index]),
            KINDS[self.kind[index]],
            self.places[self.place[index]],
            float(self.speed[index]),
            float(self.energy[index]),
        )

    def __iter__(self) -> Iterator[Event]:
        kinds = map(KINDS.__getitem__, self.kind.tolist())
        places = map(self.places.__getitem__, self.place.tolist())
        return map(Event, self.time.tolist(), kinds, places, self.speed.tolist(), self.energy.tolist())

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        counts = ", ".join(f"{self.count_of(kind)} {kind}" for kind in KINDS)
        return f"Events({len(self)}: {counts})"


#: None at all, as of a measured recording.
NO_EVENTS = Events.of(())
