"""The MCAP container: chunks in order of time across all topics, indexes and CRCs, blocks of records as arrays.

Format: https://mcap.dev/spec. Records other than messages go through the record types of the ``mcap`` package;
messages are assembled here, because one Python call a message is what makes ordinary writers slow.

A run is logged topic by topic. Its messages wait in an unnamed temporary file until the end, when each chunk takes the
messages of all topics in its stretch of time: a viewer that plays a run then needs one chunk at a time.
"""

import struct
import tempfile
import zlib
from collections.abc import Iterator, Mapping
from typing import Any, BinaryIO

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from gainsay.errors import InputError

MAGIC = b"\x89MCAP0\r\n"
PROFILE = LIBRARY = "gainsay"
COMPRESSION = "zstd"
#: bytes of a chunk before compression, of any other record, and of all chunks of a log together, at most
LARGEST_CHUNK = LARGEST_RECORD = 1 << 26
LARGEST_LOG = 1 << 32
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
_CHUNK_HEAD = struct.Struct("<QQQI")


def _packed(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


class _Waiting:
    """Messages of one channel that wait in the spool: the time of each; place, size and number of each block."""

    def __init__(self) -> None:
        self.count = 0
        self.times = np.empty(0, dtype="<u8")
        self._times: list[np.ndarray] = []
        self._blocks: list[tuple[int, int, int]] = []  # number of the first message, its place, bytes of each

    def add(self, times: np.ndarray, start: int, width: int) -> None:
        """Note a block of messages of `width` bytes each that starts at byte `start` of the spool."""
        self._times.append(times.astype("<u8"))
        self._blocks.append((self.count, start, width))
        self.count += len(times)

    def close(self) -> None:
        """Put the times into one array, in the order of writing, which is that of time."""
        self.times, self._times = np.concatenate(self._times), []
        self._first, self._place, self._width = np.array(self._blocks, dtype=np.int64).T

    def rows(self, start: int, stop: int) -> tuple[np.ndarray, np.ndarray]:
        """Return places and sizes of some messages."""
        number = np.arange(start, stop)
        block = np.searchsorted(self._first, number, side="right") - 1
        sizes = self._width[block]
        return self._place[block] + (number - self._first[block]) * sizes, sizes

    def weights(self, size: int) -> tuple[np.ndarray, np.ndarray]:
        """Return times in steps of about `size` bytes at most, and the bytes from each to the next."""
        step = max(1, size // int(self._width.max()))
        number = np.arange(0, self.count, step)
        _, sizes = (
            self.rows(0, self.count) if step == 1 else (None, np.full(len(number), step * int(self._width.max())))
        )
        return self.times[number], sizes


class Container:
    """Writes one MCAP stream.

    Parameters
    ----------
    stream : binary file
        Written strictly forward.
    chunk_size : int
        Messages of about this many bytes make a chunk; messages of one instant stay together.
    """

    def __init__(self, stream: BinaryIO, *, chunk_size: int = 1 << 20) -> None:
        self._stream, self._chunk_size = stream, chunk_size
        self._offset, self._crc = 0, 0
        self._compressor = zstandard.ZstdCompressor(level=3, write_content_size=True, write_checksum=False)
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._waiting: dict[int, _Waiting] = {}
        self._spool = tempfile.TemporaryFile()  # noqa: SIM115  # closed by `finish` or `close`
        self._write(MAGIC)
        self._write(_packed(Header(PROFILE, LIBRARY)))

    def close(self) -> None:
        """Drop what waits."""
        self._spool.close()

    def _write(self, data: bytes) -> None:
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._offset += len(data)

    def schema(self, name: str, data: bytes) -> int:
        """Register a protobuf schema and return its id."""
        made = Schema(id=len(self._schemas) + 1, name=name, encoding="protobuf", data=data)
        self._schemas.append(made)
        return made.id

    def channel(self, topic: str, schema: int, metadata: Mapping[str, str]) -> int:
        """Register a channel with its metadata and return its id."""
        if len(self._channels) == 0xFFFF:
            raise InputError("number of topics", value=len(self._channels) + 1, expected="at most 65535")
        made = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding="protobuf",
            metadata=dict(metadata),
            schema_id=schema,
        )
        self._channels.append(made)
        return made.id

    def count(self, channel: int) -> int:
        """Messages written on `channel` so far."""
        waiting = self._waiting.get(channel)
        return waiting.count if waiting else 0

    def records(self, channel: int, block: np.ndarray) -> None:
        """Append a block of complete message records, a structured array as `schemas.signal_record` lays it out.

        Channel and sequence numbers are filled in here; times must not decrease on a channel.
        """
        done = self.count(channel)
        if done + len(block) > 0xFFFFFFFF:
            raise InputError("messages on one topic", value=done + len(block), expected="at most 4294967295")
        if not len(block):
            return
        block["channel"] = channel
        block["sequence"] = np.arange(done, done + len(block), dtype=np.uint32)
        self._wait(channel, block["log_time"], block.dtype.itemsize, block.tobytes())

    def message(self, channel: int, time_ns: int, data: bytes) -> None:
        """Append one message of any length."""
        record = MESSAGE_HEAD.pack(5, 22 + len(data), channel, self.count(channel), time_ns, time_ns) + data
        self._wait(channel, np.array([time_ns], dtype="<u8"), len(record), record)

    def _wait(self, channel: int, times: np.ndarray, width: int, data: bytes) -> None:
        self._waiting.setdefault(channel, _Waiting()).add(times, self._spool.tell(), width)
        self._spool.write(data)

    def _write_chunks(self) -> None:
        """Write everything that waits, each chunk a stretch of time; the first begins with schemas and channels."""
        waiting = dict(sorted(self._waiting.items()))
        for rows in waiting.values():
            rows.close()
        head = b"".join(_packed(record) for record in (*self._schemas, *self._channels))
        for first, last in _stretches(waiting, self._chunk_size) if waiting else ([(0, 0)] if head else ()):
            parts, index, size = [head], {}, len(head)
            for channel, rows in waiting.items():
                # Unsigned as the times are: numpy would compare them as doubles with other integers.
                ends = np.searchsorted(rows.times, np.array([first, last], dtype=np.uint64), side="left")
                start, stop = (int(end) for end in ends)
                if start == stop:
                    continue
                places, sizes = rows.rows(start, stop)
                parts += self._spooled(places, sizes)
                offsets = size + np.cumsum(sizes) - sizes
                index[channel] = np.stack([rows.times[start:stop], offsets.astype("<u8")], axis=1)
                size += int(sizes.sum())
            self._chunk(b"".join(parts), index)
            head = b""

    def _spooled(self, places: np.ndarray, sizes: np.ndarray) -> Iterator[bytes]:
        """Yield the bytes of messages from the spool, those beside each other at once."""
        breaks = np.flatnonzero(places[1:] != places[:-1] + sizes[:-1]) + 1
        for start, stop in zip([0, *breaks], [*breaks, len(places)], strict=True):
            self._spool.seek(places[start])
            yield self._spool.read(int(places[stop - 1] + sizes[stop - 1] - places[start]))

    def _chunk(self, plain: bytes, index: Mapping[int, np.ndarray]) -> None:
        if len(plain) > LARGEST_CHUNK:
            raise InputError("bytes of one instant", value=len(plain), expected=f"at most {LARGEST_CHUNK}")
        packed = self._compressor.compress(plain)
        first = min((int(entries[0, 0]) for entries in index.values()), default=0)
        last = max((int(entries[-1, 0]) for entries in index.values()), default=0)
        start = self._offset
        name = COMPRESSION.encode()
        body = _CHUNK_HEAD.pack(first, last, len(plain), zlib.crc32(plain)) + struct.pack("<I", len(name)) + name
        self._write(struct.pack("<BQ", 6, len(body) + 8 + len(packed)) + body + struct.pack("<Q", len(packed)))
        self._write(packed)
        end = self._offset
        places = {}
        for channel, entries in index.items():
            places[channel] = self._offset
            data = entries.astype("<u8").tobytes()
            self._write(struct.pack("<BQHI", 7, 6 + len(data), channel, len(data)) + data)
        self._chunks.append(
            ChunkIndex(
                chunk_length=end - start,
                chunk_start_offset=start,
                compression=COMPRESSION,
                compressed_size=len(packed),
                message_end_time=last,
                message_index_length=self._offset - end,
                message_index_offsets=places,
                message_start_time=first,
                uncompressed_size=len(plain),
            )
        )

    def attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Write an attachment (with its own CRC)."""
        start = self._offset
        made = Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data)
        self._write(_packed(made))
        self._attachments.append(AttachmentIndex(start, self._offset - start, 0, 0, len(data), name, media_type))

    def metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        start = self._offset
        self._write(_packed(Metadata(name=name, metadata=dict(values))))
        self._metadata.append(MetadataIndex(start, self._offset - start, name))

    def finish(self) -> None:
        """Write the chunks and the summary section."""
        self._write_chunks()
        self.close()
        self._write(_packed(DataEnd(self._crc)))
        counts = {channel: waiting.count for channel, waiting in self._waiting.items()}
        # Ordered by time: the first chunk with a message begins where the log does, the last ends where it does.
        times = [(chunk.message_start_time, chunk.message_end_time) for chunk in self._chunks]
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=counts,
            chunk_count=len(self._chunks),
            message_count=sum(counts.values()),
            message_end_time=times[-1][1] if times else 0,
            message_start_time=times[0][0] if times else 0,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
        groups: list[tuple[int, list[Any]]] = [
            (3, self._schemas),
            (4, self._channels),
            (11, [statistics]),
            (8, self._chunks),
            (10, self._attachments),
            (13, self._metadata),
        ]
        start = self._offset
        summary, offsets = b"", b""
        for opcode, records in groups:
            if not records:
                continue
            data = b"".join(_packed(record) for record in records)
            offsets += _packed(SummaryOffset(opcode, start + len(summary), len(data)))
            summary += data
        offset_start = start + len(summary)
        summary += offsets
        crc = zlib.crc32(struct.pack("<BQQQ", 2, 20, start, offset_start), zlib.crc32(summary))
        self._write(summary)
        self._write(_packed(Footer(start, offset_start, crc)))
        self._write(MAGIC)


def _stretches(waiting: Mapping[int, _Waiting], size: int) -> list[tuple[int, int]]:
    """Split the time of all messages into stretches ``first <= t < last`` of about `size` bytes each."""
    weights = [rows.weights(size // 16) for rows in waiting.values()]
    times = np.concatenate([times for times, _ in weights])
    order = np.argsort(times, kind="stable")
    filled = np.cumsum(np.concatenate([sizes for _, sizes in weights])[order])
    begins = np.flatnonzero(np.diff((filled - 1) // size, prepend=-1))
    edges = [int(edge) for edge in np.unique(times[order][begins])]
    return list(zip(edges, [*edges[1:], max(int(rows.times[-1]) for rows in waiting.values()) + 1], strict=True))
