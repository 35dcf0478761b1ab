"""Writing the log of one run."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Any, Self

import numpy as np

from gainsay.errors import InputError
from gainsay.logs import schemas
from gainsay.logs.container import Container
from gainsay.logs.elements import Elements
from gainsay.logs.frames import transform_block

PROVENANCE = "gainsay.provenance"
EVENTS = "/events"
EXTREMES = "/extremes"
SUMMARY = "/summary"
LEVELS = ("unknown", "debug", "info", "warning", "error", "fatal")
LAST_TIME = 9.2e9  # seconds; nanoseconds must fit into 63 bits
_MEDIA = {".csv": "text/csv", ".toml": "application/toml", ".json": "application/json", ".md": "text/markdown"}
_ROWS = 1 << 16  # rows encoded at once, which bounds the memory of a call


#: (unit of a signal, unit of plots) -> factor
SHOWN = {
    ("rad", "deg"): 180.0 / math.pi,
    ("rad", "mrad"): 1e3,
    ("rad/s", "deg/s"): 180.0 / math.pi,
    ("rad/s", "mrad/s"): 1e3,
    ("N m", "mN m"): 1e3,
}


def shown_topic(topic: str, unit: str) -> str:
    """Topic of a signal in the unit of plots, such as ``/attitude/rates_deg_s``."""
    return f"{topic}_{unit.replace('/', '_').replace(' ', '_')}"


def nanoseconds(time: np.ndarray) -> np.ndarray:
    """Log time of each time in seconds: round(t 1e9) as unsigned integers."""
    return np.rint(np.asarray(time, dtype=float) * 1e9).astype(np.uint64)


class LogWriter(Elements):
    """Writes one run as an MCAP file; a context manager.

    The file appears under its name when the block ends well; on any exception it is removed. Equal calls give equal
    bytes. Every message is logged and published at round(t 1e9) nanoseconds from the simulation's zero.

    Parameters
    ----------
    path : Path
        The ``.mcap`` file to write.
    provenance : mapping
        Where the run comes from; values other than text are written as JSON. No wall clock, host or path belongs here.
    attachments : mapping of str to bytes, optional
        Files to carry along, e.g. the parameter table.
    chunk_size : int, optional
        Bytes of records in a chunk before compression.

    Raises
    ------
    InputError
        A topic, name, unit, time or shape is not as it should be.
    """

    def __init__(
        self,
        path: Path,
        *,
        provenance: Mapping[str, object],
        attachments: Mapping[str, bytes] | None = None,
        chunk_size: int = 1 << 20,
    ) -> None:
        self.path = Path(path)
        self._part = self.path.with_name(f".{self.path.name}.part")
        self._provenance = {
            key: value if isinstance(value, str) else json.dumps(value, sort_keys=True)
            for key, value in provenance.items()
        }
        self._attachments = dict(attachments or {})
        self._chunk_size = chunk_size
        self._topics: dict[str, tuple[int, str, dict[str, str]]] = {}
        self._schema_ids: dict[str, int] = {}
        self._last: dict[str, float] = {}
        self._end = 0.0
        self._bounds: dict[str, tuple[dict[str, str], list[float]]] = {}
        self._summaries: dict[str, tuple[float, str]] = {}
        self._extremes: dict[str, tuple[str, float, float, float]] = {}
        self._events: list[tuple[int, bytes]] = []
        self._container: Container | None = None

    @property
    def _out(self) -> Container:
        assert self._container is not None, "asked for inside the block alone"
        return self._container

    def __enter__(self) -> Self:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._stream = self._part.open("wb")
        try:
            self._container = Container(self._stream, chunk_size=self._chunk_size)
            self._out.metadata(PROVENANCE, self._provenance)
            for name, data in self._attachments.items():
                self._out.attachment(name, _MEDIA.get(Path(name).suffix, "application/octet-stream"), data)
        except BaseException:
            self._discard()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self._discard()
            return
        try:
            for time_ns, data in sorted(self._events, key=lambda event: event[0]):
                self._out.message(self._topics[EVENTS][0], time_ns, data)
            for name, (units, values) in self._bounds.items():
                self._numbers(f"/bounds/{name}", units, "bound", [self._end], [values])
            self._write_extremes()
            if self._summaries:
                units = {name: unit for name, (_, unit) in self._summaries.items()}
                values = [value for value, _ in self._summaries.values()]
                self._numbers(SUMMARY, units, "summary", [self._end], [values])
            self._out.finish()
            self._stream.close()
            self._part.replace(self.path)
        except BaseException:
            self._discard()
            raise
        finally:
            self._container = None

    def _discard(self) -> None:
        if self._container is not None:
            self._container.close()
        self._container = None
        self._stream.close()
        self._part.unlink(missing_ok=True)

    def _channel(self, topic: str, kind: str, units: Mapping[str, str] | None, message: str | None = None) -> int:
        """Channel of a topic, registered at first use and checked against that use afterwards."""
        if self._container is None:
            raise InputError("log is not open for writing", file=self.path.name)
        known = self._topics.get(topic)
        units = dict(units or {})
        if known is not None:
            if known[1:] != (kind, units):
                raise InputError(f"topic {topic} again as", value=(kind, units), expected=f"as before: {known[1:]}")
            return known[0]
        schemas.check_topic(topic)
        for field, unit in units.items():
            if schemas.check_name(field, f"field of {topic}") == "time":
                raise InputError(f"field of {topic}", value=field, expected="another name: time is there already")
            if not isinstance(unit, str) or not unit:
                raise InputError(f"unit of {topic}.{field}", value=unit, expected="a unit; 1 where there is none")
        name, data = schemas.foxglove_schema(message) if message else schemas.signal_schema(topic, tuple(units))
        key = message or topic
        if key not in self._schema_ids:
            self._schema_ids[key] = self._out.schema(name, data)
        metadata = {"kind": kind}
        if not message:
            metadata |= {"unit.time": "s"} | {f"unit.{field}": unit for field, unit in units.items()}
        made = self._out.channel(topic, self._schema_ids[key], metadata)
        self._topics[topic] = (made, kind, units)
        return made

    def _times(self, topic: str, time: object) -> np.ndarray:
        array = np.asarray(time, dtype=float)
        if array.ndim != 1:
            raise InputError(f"time of {topic} has shape", value=array.shape, expected="(N,)")
        bad = ~((array >= 0.0) & (array < LAST_TIME))
        if bad.any():
            raise InputError(
                f"time of {topic}", row=int(bad.argmax()), value=float(array[bad][0]), expected="0 <= t < 9.2e9 s"
            )
        if len(array):
            back = np.flatnonzero(np.diff(array, prepend=self._last.get(topic, 0.0)) < 0.0)
            if len(back):
                raise InputError(f"time of {topic} runs back to", value=float(array[back[0]]), expected="no decrease")
            self._last[topic] = float(array[-1])
            self._end = max(self._end, float(array[-1]))
        return array

    def _numbers(self, topic: str, units: Mapping[str, str], kind: str, time: Any, values: object) -> None:
        channel = self._channel(topic, kind, units)
        data = np.asarray(values, dtype=float)
        if data.ndim != 2 or data.shape != (np.shape(time)[0] if np.ndim(time) else -1, len(units)):
            expected = f"(N, {len(units)}) for time of shape {np.shape(time)}"
            raise InputError(f"values of {topic} have shape", value=data.shape, expected=expected)
        clock = self._times(topic, time)
        dtype, constants = schemas.signal_record(data.shape[1] + 1)
        for start in range(0, len(clock), _ROWS):
            some = slice(start, start + _ROWS)
            block = np.empty(len(clock[some]), dtype=dtype)
            for name, value in constants:
                block[name] = value
            block["log_time"] = block["publish_time"] = nanoseconds(clock[some])
            block["v1"] = clock[some]
            for column in range(data.shape[1]):
                block[f"v{column + 2}"] = data[some, column]
            self._out.records(channel, block)

    def signal(
        self, topic: str, fields: Mapping[str, str], time: Any, values: object, *, shown: str | None = None
    ) -> None:
        """Log a block of samples; consecutive blocks of one topic may follow each other.

        Parameters
        ----------
        topic : str
            ``/chaser/state`` and the like.
        fields : mapping of str to str
            Unit of each component, in the order of the columns.
        time : (N,) array_like
            Seconds from the simulation's zero, not decreasing.
        values : (N, k) array_like
            One column for each component; every double comes back bit for bit.
        shown : str, optional
            Another unit, that of plots: the same samples are logged in it too, on ``<topic>_<unit>``. Viewers do not
            convert; no quantity is computed from these.
        """
        self._numbers(topic, fields, "signal", time, values)
        if shown is not None:
            units = set(fields.values())
            factor = SHOWN.get((min(units), shown)) if len(units) == 1 else None
            if factor is None:
                raise InputError(f"unit of {topic} for plots", value=shown, expected=f"one made of {sorted(units)}")
            data = factor * np.asarray(values, dtype=float)
            self._numbers(shown_topic(topic, shown), dict.fromkeys(fields, shown), "shown", time, data)

    def event(self, time: float, name: str, text: str, level: str = "info") -> None:
        """Log an event for the text log of the viewers (``foxglove.Log``); its time is kept to the nanosecond."""
        if level not in LEVELS:
            raise InputError("level of an event", value=level, expected="one of " + ", ".join(LEVELS))
        self._channel(EVENTS, "events", None, "Log")
        time_ns = self._moment(f"event {name}", time)
        message = schemas.foxglove_class("Log")(level=LEVELS.index(level), message=text, name=name)
        message.timestamp.seconds, message.timestamp.nanos = divmod(time_ns, 10**9)
        # Kept until the end: extremes are often found late, and a topic should be in order of time.
        self._events.append((time_ns, message.SerializeToString(deterministic=True)))

    def _moment(self, what: str, time: float) -> int:
        if not 0.0 <= time < LAST_TIME:
            raise InputError(f"time of {what}", value=time, expected="0 <= t < 9.2e9 s")
        self._end = max(self._end, float(time))
        return int(nanoseconds(np.array([time]))[0])

    def extreme(
        self,
        name: str,
        time: float,
        value: float,
        unit: str,
        *,
        second: float = math.nan,
        limit: float | None = None,
    ) -> None:
        """Log a located extreme: exact doubles on ``/extremes`` at the end of the log, and an event that tells of it.

        Parameters
        ----------
        name : str
            Its fields are ``<name>``, ``<name>_time`` and ``<name>_second``.
        time, value : float
            Where it is, s, and what it is, in `unit`.
        unit : str
        second : float, optional
            The value by a second method.
        limit : float, optional
            A limit of the modulus: where it is passed, by more than rounding (1e-9 of it), the event is a warning that
            says so.
        """
        schemas.check_name(name, "extreme")
        if name in self._extremes:
            raise InputError("extreme logged twice", value=name, expected="each once")
        self._extremes[name] = (unit, float(value), float(time), float(second))
        of = "" if unit == "1" else f" {unit}"
        text = f"extreme {name}: {value:.6g}{of} at {time:.6g} s"
        passed = limit is not None and not abs(value) <= limit * (1.0 + 1e-9)
        self.event(
            time,
            name,
            f"{text}, beyond the limit of {limit:.6g}{of}" if passed else text,
            level="warning" if passed else "info",
        )

    def extremes(
        self,
        first: Mapping[str, tuple[float, float, str]],
        second: Mapping[str, tuple[float, float, str]],
        *,
        limits: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        """Log the located extremes of a run by two methods, see `extreme`.

        Parameters
        ----------
        first, second : mapping of str to (float, float, str)
            By name: time (s), value and unit; of the second method the values alone are kept.
        limits : mapping of str to float, optional
            Limits of the moduli, by name.

        Raises
        ------
        KeyError
            If the second method lacks an extreme.
        """
        for name, (time, value, unit) in first.items():
            self.extreme(name, time, value, unit, second=second[name][1], limit=limits.get(name))

    def _write_extremes(self) -> None:
        units, values = {}, []
        for name, (unit, value, time, second) in self._extremes.items():
            for field, number, of in (
                (name, value, unit),
                (f"{name}_time", time, "s"),
                (f"{name}_second", second, unit),
            ):
                if field in units:
                    raise InputError("field of an extreme twice", value=field, expected="another name")
                units[field] = of
                values.append(number)
        if units:
            self._numbers(EXTREMES, units, "extreme", [self._end], [values])

    def summary(self, name: str, value: float, unit: str) -> None:
        """Log a number known only at the end, as a field of ``/summary`` at the last time of the log."""
        schemas.check_name(name, "summary")
        if name in self._summaries:
            raise InputError("summary logged twice", value=name, expected="each once")
        self._summaries[name] = (float(value), unit)

    def bound(self, name: str, unit: str, *, lower: float | None = None, upper: float | None = None) -> None:
        """Log a bound as constants ``lower`` and ``upper`` on ``/bounds/<name>``, from 0 to the end of the log."""
        ends = {key: value for key, value in (("lower", lower), ("upper", upper)) if value is not None}
        if not ends or not all(math.isfinite(value) for value in ends.values()):
            raise InputError(f"bound {name}", value=ends, expected="a finite lower or upper value, or both")
        if name in self._bounds:
            raise InputError("bound logged twice", value=name, expected="each once")
        units, values = dict.fromkeys(ends, unit), [float(value) for value in ends.values()]
        self._numbers(f"/bounds/{name}", units, "bound", [0.0], [values])
        self._bounds[name] = (units, values)

    def transform(
        self, parent: str, child: str, time: object, translation: object, rotation: object | None = None
    ) -> None:
        """Relate two frames over time, as ``foxglove.FrameTransforms`` on ``/tf/<child>``.

        Parameters
        ----------
        parent, child : str
            Names of the frames.
        time : (N,) array_like
            Seconds; one sample is enough for frames at rest.
        translation : (N, 3) array_like
            Origin of the child in the parent, m.
        rotation : (N, 4) array_like, optional
            Unit quaternion x, y, z, w that takes child components to parent components; identity by default.
        """
        for frame in (parent, child):
            schemas.check_name(frame, "frame")
        key = f"/tf/{child}"
        channel = self._channel(key, "transforms", None, "FrameTransforms")
        clock = self._times(key, time)
        count = len(clock)
        shift = np.asarray(translation, dtype=float)
        turn = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)) if rotation is None else np.asarray(rotation, dtype=float)
        if shift.shape != (count, 3) or turn.shape != (count, 4):
            raise InputError(f"{key}: shapes", value=(shift.shape, turn.shape), expected=f"({count}, 3), ({count}, 4)")
        if not (np.isfinite(shift).all() and (abs(np.linalg.norm(turn, axis=1) - 1.0) < 1e-6).all()):
            raise InputError(key, expected="finite translations and unit quaternions")
        for start in range(0, count, _ROWS):
            some = slice(start, start + _ROWS)
            self._out.records(
                channel, transform_block(parent, child, nanoseconds(clock[some]), shift[some], turn[some])
            )

    def _scene(self, name: str, time: float, entity: Any) -> None:
        """Write one entity as a ``foxglove.SceneUpdate`` on ``/scene/<name>``."""
        schemas.check_name(name, "scene element")
        channel = self._channel(f"/scene/{name}", "scene", None, "SceneUpdate")
        time_ns = self._moment(f"scene element {name}", time)
        self._times(f"/scene/{name}", [time])
        entity.id = name
        entity.timestamp.seconds, entity.timestamp.nanos = divmod(time_ns, 10**9)
        update = schemas.foxglove_class("SceneUpdate")(entities=[entity])
        self._out.message(channel, time_ns, update.SerializeToString(deterministic=True))
