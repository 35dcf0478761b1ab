"""Strict reading of a chunk: schemas, channels and messages, each checked against what may stand there."""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import zstandard

from gainsay.logs.container import COMPRESSION, LARGEST_CHUNK, LARGEST_LOG, LARGEST_RECORD
from gainsay.logs.records import NAMES, Fields, Place, records
from gainsay.logs.schemas import signal_record, signal_schema

#: bytes of samples and messages that are kept in memory; those of a larger log are read again where they are asked for
KEPT = 1 << 25
_MESSAGE = struct.Struct("<HIQQ")


@dataclass
class RawChannel:
    """A channel as found, with what was read of it so far, as far as it is kept."""

    id: int
    topic: str
    schema_name: str
    schema_data: bytes
    metadata: dict[str, str]
    width: int | None = None  # doubles a message, the time included; None where messages are not fixed-width
    count: int = 0
    last: float = 0.0  # time of the last message of doubles, s
    blocks: list[np.ndarray] = field(default_factory=list)
    messages: list[tuple[int, bytes]] = field(default_factory=list)

    @property
    def doubles(self) -> int:
        """Doubles of a message of a channel that has a fixed width."""
        assert self.width is not None, f"{self.topic} has messages for viewers"
        return self.width


@dataclass(frozen=True)
class ChunkPlace:
    """Where the content of a chunk record stands in the file, its CRC, and the channels it has messages of."""

    at: int
    start: int
    end: int
    crc: int
    channels: frozenset[int]


@dataclass
class RawLog:
    """Contents of a file, checked as far as the container goes."""

    channels: dict[int, RawChannel] = field(default_factory=dict)
    schemas: dict[int, tuple[str, bytes]] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    chunks: list[ChunkPlace] = field(default_factory=list)
    topics: set[str] = field(default_factory=set)
    size: int = 0  # bytes of all chunks before compression
    described: int = 0  # bytes of schemas, channels, metadata and attachments, which are always kept
    kept: int = 0
    keeps: bool = True

    def describe(self, size: int, at: int, where: Place) -> None:
        """Count bytes of what is always kept."""
        self.described += size
        if self.described > LARGEST_RECORD:
            expected = f"at most {LARGEST_RECORD}"
            raise where.error(f"{self.described} bytes of schemas, channels, metadata and attachments", at, expected)

    def keep(self, size: int) -> bool:
        """Say whether so many bytes more are kept; where that would be too much, nothing is kept any more."""
        self.kept += size
        if self.keeps and self.kept > KEPT:
            self.keeps = False
            for channel in self.channels.values():
                channel.blocks.clear()
                channel.messages.clear()
        return self.keeps


def open_chunk(fields: Fields, at: int, log: RawLog, where: Place) -> tuple[bytes, int]:
    """Decompress a chunk and check its size and CRC, once it is known to stay within the limits.

    Returns
    -------
    data : bytes
        The records of the chunk.
    crc : int
        Its CRC.
    """
    fields.number("Q"), fields.number("Q")
    size, crc, kind = fields.number("Q"), fields.number("I"), fields.text()
    packed = fields.blob("Q")
    fields.done()
    if kind != COMPRESSION:
        raise where.error(f"chunk compressed by {kind!r}", at, f"{COMPRESSION!r}")
    if size > LARGEST_CHUNK or log.size + size > LARGEST_LOG:
        expected = f"at most {LARGEST_CHUNK} bytes, and {LARGEST_LOG} in all chunks together"
        raise where.error(f"chunk of {size} bytes after {log.size}", at, expected)
    try:
        if zstandard.frame_content_size(packed) != size:
            raise where.error(f"chunk of {size} bytes holds another size", at)
        plain = zstandard.ZstdDecompressor().decompress(packed, allow_extra_data=False)
    except zstandard.ZstdError:
        raise where.error("chunk does not decompress", at) from None
    if len(plain) != size or zlib.crc32(plain) != crc:
        raise where.error("CRC of the chunk does not match", at)
    return plain, crc


def read_chunk(data: bytes, log: RawLog, where: Place) -> frozenset[int]:
    """Check all records of a chunk, add what they say to the log, and return the channels that have messages in it."""
    at, seen = 0, set()
    while at < len(data):
        opcode, start, body, end = next(records(data, at, len(data), where))
        if opcode == 5:
            channel = _channel_of(data, start, body, end, log, where)
            seen.add(channel.id)
            if channel.width is None:
                _read_message(data, start, body, end, channel, log, where)
            else:
                end = _read_block(data, start, end, channel, log, where)
        elif opcode in (3, 4):
            log.describe(end - start, start, where)
            fields = Fields(data, body, end, where)
            (_read_schema if opcode == 3 else _read_channel)(fields, start, log, where)
            fields.done()
        else:
            raise where.error(f"{NAMES[opcode]} inside a chunk", start)
        at = end
    return frozenset(seen)


def messages_again(data: bytes, channel: RawChannel, log: RawLog, where: Place) -> Iterator[np.ndarray | tuple]:
    """Yield what a chunk that was checked before holds of a channel: blocks of records, or time and bytes of each."""
    at = 0
    while at < len(data):
        opcode, start, body, end = next(records(data, at, len(data), where))
        if opcode == 5:
            number, _, time, _ = _MESSAGE.unpack_from(data, body)
            if log.channels[number].width is not None:
                block = _block(data, start, log.channels[number])
                end = start + block.nbytes
            if number == channel.id:
                yield (time, data[body + _MESSAGE.size : end]) if channel.width is None else block
        at = end


def _read_schema(fields: Fields, start: int, log: RawLog, where: Place) -> None:
    number, name, encoding = fields.number("H"), fields.text(), fields.text()
    if number == 0 or number in log.schemas or encoding != "protobuf":
        raise where.error(f"schema {number} encoded as {encoding!r}", start, "a new one in protobuf")
    log.schemas[number] = name, fields.blob()


def _read_channel(fields: Fields, start: int, log: RawLog, where: Place) -> None:
    number, schema, topic, encoding = fields.number("H"), fields.number("H"), fields.text(), fields.text()
    if number in log.channels or schema not in log.schemas or encoding != "protobuf":
        raise where.error(f"channel {number} ({topic}) of schema {schema}", start, "a new one, schema known")
    if topic in log.topics:
        raise where.error(f"topic {topic} twice", start)
    log.topics.add(topic)
    log.channels[number] = _channel(number, topic, log.schemas[schema], fields.pairs(), start, where)


def _channel(
    number: int, topic: str, schema: tuple[str, bytes], metadata: dict[str, str], start: int, where: Place
) -> RawChannel:
    """Build a channel; one with units must have the schema that its topic and fields imply."""
    made = RawChannel(number, topic, *schema, metadata)
    fields = [key.removeprefix("unit.") for key in metadata if key.startswith("unit.")]
    if fields:
        try:
            fits = fields[0] == "time" and signal_schema(topic, tuple(fields[1:])) == schema
        except (ValueError, TypeError):
            fits = False
        if not fits:
            raise where.error(f"schema of {topic} is not that of its fields", start)
        made.width = len(fields)
    return made


def _channel_of(data: bytes, start: int, body: int, end: int, log: RawLog, where: Place) -> RawChannel:
    if end - body < _MESSAGE.size:
        raise where.error(f"message of {end - body} bytes", start, "at least 22")
    number = _MESSAGE.unpack_from(data, body)[0]
    if number not in log.channels:
        raise where.error(f"message on unknown channel {number}", start)
    return log.channels[number]


def _read_message(data: bytes, start: int, body: int, end: int, channel: RawChannel, log: RawLog, where: Place) -> None:
    """Check a message for viewers."""
    _, sequence, time, published = _MESSAGE.unpack_from(data, body)
    if sequence != channel.count or time != published:
        raise where.error(f"message {sequence} of {channel.topic} at {time}", start, f"number {channel.count}")
    if log.keep(end - start):
        channel.messages.append((time, data[body + _MESSAGE.size : end]))
    channel.count += 1


def _block(data: bytes, start: int, channel: RawChannel) -> np.ndarray:
    """Return the message at `start` and all that follow it on the same channel, as an array of records."""
    dtype, _ = signal_record(channel.doubles)
    block = np.frombuffer(data, dtype, count=(len(data) - start) // dtype.itemsize, offset=start)
    return block[: _run(block, channel.id)]


def _read_block(data: bytes, start: int, end: int, channel: RawChannel, log: RawLog, where: Place) -> int:
    """Check the message at `start` and all that follow it on the same channel; return where they end."""
    dtype, constants = signal_record(channel.doubles)
    if end - start != dtype.itemsize:
        raise where.error(f"message of {end - start - 9} bytes on {channel.topic}", start, str(dtype.itemsize - 9))
    block = _block(data, start, channel)
    for name, value in constants:
        wrong = np.flatnonzero(block[name] != value)
        if len(wrong):
            row = int(wrong[0])
            raise where.error(f"message of {channel.topic}: {name}", start + row * dtype.itemsize, str(value))
    expected = np.arange(channel.count, channel.count + len(block), dtype=np.uint64)
    seconds = block["v1"]
    with np.errstate(invalid="ignore"):
        good = (block["sequence"] == expected) & (seconds >= 0.0) & (seconds < 9.2e9)
        stamps = np.rint(np.where(good, seconds, 0.0) * 1e9).astype(np.uint64)
    good &= (block["log_time"] == stamps) & (block["publish_time"] == stamps)
    good &= np.diff(seconds, prepend=channel.last) >= 0.0
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        raise where.error(
            f"message of {channel.topic}: number or time", start + row * dtype.itemsize, f"number {int(expected[row])}"
        )
    if log.keep(8 * channel.doubles * len(block)):
        channel.blocks.append(doubles(block, range(channel.doubles)))
    channel.count += len(block)
    channel.last = float(block["v1"][-1])
    return start + block.nbytes


def doubles(block: np.ndarray, columns: range) -> np.ndarray:
    """Return some of the doubles (N, k) of a block of records, the time being column 0."""
    values = np.empty((len(block), len(columns)))
    for place, column in enumerate(columns):
        values[:, place] = block[f"v{column + 1}"]
    return values


def _run(block: np.ndarray, number: int) -> int:
    """Length of the run of records at the start of `block` that are messages on channel `number`.

    Looks ahead in growing steps: topics that alternate cost a look each, a long run only a few.
    """
    done, step = 0, 16
    while done < len(block):
        part = block[done : done + step]
        other = np.flatnonzero(
            (part["opcode"] != 5) | (part["length"] != block.itemsize - 9) | (part["channel"] != number)
        )
        if len(other):
            return done + int(other[0])
        done += len(part)
        step *= 8
    return done
