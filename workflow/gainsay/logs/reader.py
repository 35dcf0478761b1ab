"""Reading a log back: the same doubles, or an error that says where the file broke."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from google.protobuf.message import DecodeError

from gainsay.errors import LogError
from gainsay.logs.scan import RawChannel, RawLog, scan
from gainsay.logs.schemas import foxglove_class
from gainsay.logs.writer import EVENTS, LEVELS, PROVENANCE

if TYPE_CHECKING:
    import pandas

_KINDS = ("signal", "bound", "extreme", "summary")
_MESSAGES = {"events": "Log", "transforms": "FrameTransforms", "scene": "SceneUpdate"}


@dataclass(frozen=True)
class Signal:
    """Samples of one topic.

    Attributes
    ----------
    topic : str
    fields : tuple of str
        Names of the columns.
    units : mapping of str to str
        Unit of each field.
    time : (N,) ndarray
        Seconds from the simulation's zero.
    values : (N, k) ndarray
        One column for each field, bit for bit as written.
    """

    topic: str
    fields: tuple[str, ...]
    units: Mapping[str, str]
    time: np.ndarray
    values: np.ndarray

    def column(self, field: str) -> np.ndarray:
        """Return the samples (N,) of one field.

        Raises
        ------
        LogError
            The signal has no such field.
        """
        if field not in self.fields:
            raise LogError(f"no field in {self.topic}", value=field, expected="one of " + ", ".join(self.fields))
        return self.values[:, self.fields.index(field)]

    def columns(self, *fields: str) -> np.ndarray:
        """Return the samples (N, len(fields)) of several fields."""
        return np.stack([self.column(field) for field in fields], axis=1)

    def frame(self) -> "pandas.DataFrame":
        """Table with the time as index and a column for each field; units in ``attrs["units"]``."""
        import pandas

        table = pandas.DataFrame(self.values, columns=list(self.fields), index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = dict(self.units)
        return table


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

    def __init__(self, path: Path, raw: RawLog, size: int) -> None:
        self.path, self.size = path, size
        self.metadata: Mapping[str, str] = MappingProxyType(raw.metadata.get(PROVENANCE, {}))
        self.attachments: Mapping[str, bytes] = MappingProxyType(raw.attachments)
        self._raw = {channel.topic: channel for channel in raw.channels.values()}
        self._signals = {topic: self._signal(raw) for topic, raw in self._raw.items() if raw.width is not None}
        self.extremes = MappingProxyType(
            {
                name: Extreme(time, value, second)
                for _, found in self._of_kind("extreme")
                for name, value, time, second in zip(
                    found.fields[::3], *(found.values[0, start::3].tolist() for start in range(3)), strict=True
                )
            }
        )
        self.summaries = MappingProxyType(
            {
                name: value
                for _, found in self._of_kind("summary")
                for name, value in zip(found.fields, found.values[0].tolist(), strict=True)
            }
        )
        self.bounds = MappingProxyType(
            {
                topic.removeprefix("/bounds/"): dict(zip(found.fields, found.values[0].tolist(), strict=True))
                for topic, found in self._of_kind("bound")
            }
        )

    def _of_kind(self, kind: str) -> list[tuple[str, Signal]]:
        found = [(t, s) for t, s in self._signals.items() if self._raw[t].metadata.get("kind") == kind]
        for topic, signal in found:
            if not len(signal.time):
                raise LogError(f"no message on {topic}", file=self.path.name, expected="one at least")
        return found

    @staticmethod
    def _signal(raw: RawChannel) -> Signal:
        data = np.concatenate(raw.blocks) if raw.blocks else np.empty((0, raw.width))
        units = {key.removeprefix("unit."): unit for key, unit in raw.metadata.items() if key.startswith("unit.")}
        units.pop("time")
        values = np.ascontiguousarray(data[:, 1:])
        return Signal(raw.topic, tuple(units), MappingProxyType(units), data[:, 0].copy(), values)

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
        return max((float(found.time[-1]) for found in self._signals.values() if len(found.time)), default=0.0)

    def messages(self, topic: str) -> list[tuple[float, Any]]:
        """Time and protobuf message of every message on a topic for viewers (events, transforms, scene)."""
        raw = self._raw.get(topic)
        if raw is None or self.kind(topic) not in _MESSAGES:
            raise LogError("no messages for viewers on", file=self.path.name, value=topic)
        kind = foxglove_class(_MESSAGES[self.kind(topic)])
        try:
            return [(time / 1e9, kind.FromString(data)) for time, data in raw.messages]
        except DecodeError:
            raise LogError(f"message of {topic} does not decode", file=self.path.name) from None

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Events in order of time."""
        if EVENTS not in self._raw:
            return ()
        found = [Event(t, m.name, m.message, LEVELS[m.level % len(LEVELS)]) for t, m in self.messages(EVENTS)]
        return tuple(sorted(found, key=lambda event: event.time))

    @cached_property
    def frames(self) -> Mapping[str, str]:
        """Parent of every frame that a transform relates."""
        return {
            turn.child_frame_id: turn.parent_frame_id
            for topic in self._raw
            if self.kind(topic) == "transforms"
            for _, message in self.messages(topic)
            for turn in message.transforms
        }


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
        data = path.read_bytes()
    except OSError as error:
        raise LogError(error.strerror or "cannot be read", file=str(path)) from None
    return Log(path, scan(data, path.name), len(data))
