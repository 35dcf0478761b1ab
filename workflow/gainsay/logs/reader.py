"""Reading a log back: the same doubles, or an error that says where the file broke."""

import os
import weakref
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np
from google.protobuf.message import DecodeError

from gainsay.errors import InputError, LogError, missing_extra
from gainsay.logs.scan import RawChannel, RawLog, again, columns_of, scan
from gainsay.logs.schemas import foxglove_class
from gainsay.logs.writer import EVENTS, EXTREMES, LEVELS, PROVENANCE, SUMMARY
from gainsay.tables.files import open_regular

if TYPE_CHECKING:
    import pandas

_MESSAGES = {"events": "Log", "transforms": "FrameTransforms", "scene": "SceneUpdate"}


class Signal:
    """Samples of one topic.

    Those of a small log are kept in memory; those of a large one are read from the file at each access, so that a
    column of ten million samples takes 80 MB and no more.

    Attributes
    ----------
    topic : str
    fields : tuple of str
        Names of the columns.
    units : mapping of str to str
        Unit of each field.
    count : int
        Number of samples N.
    time : (N,) ndarray
        Seconds from the simulation's zero.
    values : (N, k) ndarray
        One column for each field, bit for bit as written.
    """

    def __init__(
        self, topic: str, units: Mapping[str, str], count: int, load: Callable[[range], np.ndarray], keep: bool
    ) -> None:
        self.topic, self.count = topic, count
        self.units: Mapping[str, str] = MappingProxyType(dict(units))
        self.fields = tuple(units)
        self._load, self._keep = load, keep
        self._kept: dict[range, np.ndarray] = {}

    def _columns(self, columns: range) -> np.ndarray:
        if columns in self._kept:
            return self._kept[columns]
        values = self._load(columns)
        if self._keep:
            self._kept[columns] = values
        return values

    @property
    def time(self) -> np.ndarray:
        """Seconds from the simulation's zero."""
        return self._columns(range(1))[:, 0]

    @property
    def values(self) -> np.ndarray:
        """One column for each field."""
        return self._columns(range(1, len(self.fields) + 1))

    def column(self, field: str) -> np.ndarray:
        """Return the samples (N,) of one field.

        Raises
        ------
        LogError
            The signal has no such field.
        """
        if field not in self.fields:
            raise LogError(f"no field in {self.topic}", value=field, expected="one of " + ", ".join(self.fields))
        place = self.fields.index(field)
        return self.values[:, place] if self._keep else self._load(range(place + 1, place + 2))[:, 0]

    def columns(self, *fields: str) -> np.ndarray:
        """Return the samples (N, len(fields)) of several fields."""
        return np.stack([self.column(field) for field in fields], axis=1)

    def frame(self) -> "pandas.DataFrame":
        """Table with the time as index and a column for each field; units in ``attrs["units"]``."""
        try:
            import pandas
        except ImportError:
            raise InputError("pandas is not installed", expected=missing_extra("pandas")) from None

        table = pandas.DataFrame(self.values, columns=list(self.fields), index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = dict(self.units)
        return table


class _Named(dict):
    """Numbers of a log by name; one that is not there is said to be missing from the log."""

    def __init__(self, file: str, kind: str) -> None:
        super().__init__()
        self.file, self.kind = file, kind

    def __missing__(self, name: str) -> Any:
        expected = f"one of {', '.join(self)}" if self else "a log that has one"
        raise LogError(f"no {self.kind}", file=self.file, value=name, expected=expected)


@dataclass(frozen=True)
class Event:
    """One line of the text log; its time is exact to the nanosecond."""

    time: float
    name: str
    text: str
    level: str


class Extreme(NamedTuple):
    """A located extreme.

    Attributes
    ----------
    time : float
        Where it is, s.
    value : float
    second : float
        The value by a second method; NaN where there is none.
    """

    time: float
    value: float
    second: float


def _extremes(signal: Signal) -> dict[str, Extreme]:
    """Extremes of a message: of each its value, its time and its second value; nothing where a field is another."""
    names, row = signal.fields[::3], signal.values[0].tolist()
    if signal.fields != tuple(field for name in names for field in (name, f"{name}_time", f"{name}_second")):
        return {}
    return {name: Extreme(row[k + 1], row[k], row[k + 2]) for k, name in zip(range(0, len(row), 3), names, strict=True)}


def _summaries(signal: Signal) -> dict[str, float]:
    return dict(zip(signal.fields, signal.values[0].tolist(), strict=True))


def _bound(signal: Signal) -> dict[str, dict[str, float]]:
    if not set(signal.fields) <= {"lower", "upper"} or not signal.fields:
        return {}
    return {signal.topic.removeprefix("/bounds/"): _summaries(signal)}


class Log(Mapping[str, Signal]):
    """Contents of one log: a mapping from topic to `Signal`.

    Attributes
    ----------
    path : Path
    metadata : mapping of str to str
        Provenance.
    attachments : mapping of str to bytes
    extremes : mapping of str to Extreme
        Every located extreme.
    summaries : mapping of str to float
        Numbers logged at the end.
    bounds : mapping of str to mapping
        ``lower`` and ``upper`` of each bound.
    """

    def __init__(self, path: Path, raw: RawLog, stream: BinaryIO) -> None:
        self.path, self.size = path, os.fstat(stream.fileno()).st_size
        self.metadata: Mapping[str, str] = MappingProxyType(raw.metadata.get(PROVENANCE, {}))
        self.attachments: Mapping[str, bytes] = MappingProxyType(raw.attachments)
        self._content, self._stream = raw, stream
        if raw.keeps:
            stream.close()
        else:
            weakref.finalize(self, stream.close)
        self._raw = {channel.topic: channel for channel in raw.channels.values()}
        self._signals = {topic: self._signal(raw) for topic, raw in self._raw.items() if raw.width is not None}
        self.extremes: Mapping[str, Extreme] = self._named("extreme", EXTREMES, _extremes)
        self.summaries: Mapping[str, float] = self._named("summary", SUMMARY, _summaries)
        self.bounds: Mapping[str, Mapping[str, float]] = self._named("bound", "/bounds/", _bound)

    def _named(self, kind: str, place: str, read: Callable[[Signal], Mapping[str, Any]]) -> Mapping[str, Any]:
        """Return what the topics of a kind hold, by name."""
        named = _Named(self.path.name, kind)
        for topic, signal in self._signals.items():
            if self.kind(topic) != kind:
                continue
            # as many messages as the writer gives such a topic: one, or a bound at both ends of the time
            counted = signal.count == (2 if kind == "bound" else 1)
            values = (
                read(signal) if counted and (topic == place or (kind == "bound" and topic.startswith(place))) else {}
            )
            if not values:
                what = f"{signal.count} messages of {', '.join(signal.fields) or 'nothing'} on {topic}"
                raise LogError(f"{what}, of the kind {kind}", file=self.path.name, expected="what a log has of it")
            named.update(values)
        return MappingProxyType(named)

    def _signal(self, raw: RawChannel) -> Signal:
        units = {key.removeprefix("unit."): unit for key, unit in raw.metadata.items() if key.startswith("unit.")}
        units.pop("time")
        content, stream, file = self._content, self._stream, self.path.name
        return Signal(
            raw.topic, units, raw.count, lambda columns: columns_of(stream, file, content, raw, columns), content.keeps
        )

    def __getitem__(self, topic: str) -> Signal:
        try:
            return self._signals[topic]
        except KeyError:
            expected = "one of " + ", ".join(self._signals)
            raise LogError("no signal", file=self.path.name, value=topic, expected=expected) from None

    def __contains__(self, topic: object) -> bool:
        return topic in self._signals

    def __iter__(self) -> Iterator[str]:
        return iter(self._signals)

    def __len__(self) -> int:
        return len(self._signals)

    @property
    def topics(self) -> tuple[str, ...]:
        """Every topic of the file, those for viewers included."""
        return tuple(self._raw)

    def kind(self, topic: str) -> str:
        """Say what a topic holds: signal, bound, extreme, summary, events, transforms or scene."""
        return self._raw[topic].metadata.get("kind", "")

    def count(self, topic: str) -> int:
        """Messages on a topic."""
        return self._raw[topic].count

    @property
    def duration(self) -> float:
        """Last time of any signal, s."""
        return max((self._raw[topic].last for topic in self._signals), default=0.0)

    def messages(self, topic: str) -> list[tuple[float, Any]]:
        """Time and protobuf message of every message on a topic for viewers (events, transforms, scene)."""
        raw = self._raw.get(topic)
        if raw is None or raw.width is not None or self.kind(topic) not in _MESSAGES:
            raise LogError("no messages for viewers on", file=self.path.name, value=topic)
        kind = foxglove_class(_MESSAGES[self.kind(topic)])
        kept = self._content.keeps
        try:
            messages = raw.messages if kept else again(self._stream, self.path.name, self._content, raw)
            return [(time / 1e9, kind.FromString(data)) for time, data in messages]
        except DecodeError:
            raise LogError(f"message of {topic} does not decode", file=self.path.name) from None

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Events in order of time."""
        if EVENTS not in self._raw:
            return ()
        events = [Event(t, m.name, m.message, LEVELS[m.level % len(LEVELS)]) for t, m in self.messages(EVENTS)]
        return tuple(sorted(events, key=lambda event: event.time))

    @cached_property
    def transforms(self) -> Mapping[str, tuple[str, np.ndarray]]:
        """Parent of every frame that a transform relates, and the places (N, 3) of its origin there, m."""
        parents: dict[str, str] = {}
        places: dict[str, list[tuple[float, float, float]]] = {}
        for topic in self._raw:
            if self.kind(topic) == "transforms":
                for _, message in self.messages(topic):
                    for turn in message.transforms:
                        child, place = turn.child_frame_id, turn.translation
                        parents[child] = turn.parent_frame_id
                        places.setdefault(child, []).append((place.x, place.y, place.z))
        return {child: (parent, np.array(places[child])) for child, parent in parents.items()}

    @property
    def frames(self) -> Mapping[str, str]:
        """Parent of every frame that a transform relates."""
        return {child: parent for child, (parent, _) in self.transforms.items()}


def read_log(path: Path) -> Log:
    """Read and check a whole log.

    Parameters
    ----------
    path : Path
        An ``.mcap`` file written by `LogWriter`.

    Raises
    ------
    LogError
        The file is missing, damaged or not of this kind; damage is named with the byte where it broke.
    """
    path = Path(path)
    try:
        stream = open_regular(path)
    except InputError as error:
        raise LogError(error.message, file=str(path), expected=error.expected) from None
    try:
        return Log(path, scan(stream, path.name), stream)
    except BaseException:
        stream.close()
        raise
