"""The MCAP container: chunks, indexes and CRCs, written in one pass with blocks of records as arrays.

Format: https://mcap.dev/spec. Records other than messages go through the record types of the ``mcap`` package;
messages are assembled here, because one Python call a message is what makes ordinary writers slow.
"""

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

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
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
_CHUNK_HEAD = struct.Struct("<QQQI")


def _packed(record: object) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


class Container:
    """Writes one MCAP stream.

    Parameters
    ----------
    stream : binary file
        Written strictly forward.
    chunk_size : int
        A chunk is closed when its records reach this many bytes.
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
        self._counts: dict[int, int] = {}
        self._first, self._last = None, 0
        self._new_chunk()
        self._write(MAGIC)
        self._write(_packed(Header(PROFILE, LIBRARY)))

    def _write(self, data: bytes) -> None:
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._offset += len(data)

    def _new_chunk(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0
        self._index: dict[int, list[np.ndarray]] = {}
        self._span: list[int] = []

    def _append(self, data: bytes) -> None:
        self._parts.append(data)
        self._size += len(data)

    def schema(self, name: str, data: bytes) -> int:
        """Register a protobuf schema and return its id."""
        made = Schema(id=len(self._schemas) + 1, name=name, encoding="protobuf", data=data)
        self._schemas.append(made)
        self._append(_packed(made))
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
        self._append(_packed(made))
        return made.id

    def count(self, channel: int) -> int:
        """Messages written on `channel` so far."""
        return self._counts.get(channel, 0)

    def records(self, channel: int, block: np.ndarray) -> None:
        """Append a block of complete message records, a structured array as `schemas.signal_record` lays it out.

        Channel and sequence numbers are filled in here; the block is split where a chunk is full.
        """
        width = block.dtype.itemsize
        done = self.count(channel)
        if done + len(block) > 0xFFFFFFFF:
            raise InputError("messages on one topic", value=done + len(block), expected="at most 4294967295")
        block["channel"] = channel
        block["sequence"] = np.arange(done, done + len(block), dtype=np.uint32)
        start = 0
        while start < len(block):
            stop = min(len(block), start + max(1, (self._chunk_size - self._size) // width))
            part = block[start:stop]
            index = np.empty((stop - start, 2), dtype="<u8")
            index[:, 0] = part["log_time"]
            index[:, 1] = self._size + width * np.arange(stop - start, dtype=np.uint64)
            self._index.setdefault(channel, []).append(index)
            self._span += [int(index[:, 0].min()), int(index[:, 0].max())]
            self._append(part.tobytes())
            if self._size >= self._chunk_size - width:
                self._close_chunk()
            start = stop
        self._counts[channel] = done + len(block)

    def message(self, channel: int, time_ns: int, data: bytes) -> None:
        """Append one message of any length."""
        done = self.count(channel)
        self._index.setdefault(channel, []).append(np.array([[time_ns, self._size]], dtype="<u8"))
        self._span.append(time_ns)
        self._append(MESSAGE_HEAD.pack(5, 22 + len(data), channel, done, time_ns, time_ns) + data)
        self._counts[channel] = done + 1
        if self._size >= self._chunk_size:
            self._close_chunk()

    def _close_chunk(self) -> None:
        if not self._parts:
            return
        plain = b"".join(self._parts)
        packed = self._compressor.compress(plain)
        first, last = (min(self._span), max(self._span)) if self._span else (0, 0)
        if self._span:
            self._first = first if self._first is None else min(self._first, first)
            self._last = max(self._last, last)
        start = self._offset
        name = COMPRESSION.encode()
        body = _CHUNK_HEAD.pack(first, last, len(plain), zlib.crc32(plain)) + struct.pack("<I", len(name)) + name
        self._write(struct.pack("<BQ", 6, len(body) + 8 + len(packed)) + body + struct.pack("<Q", len(packed)))
        self._write(packed)
        end = self._offset
        places = {}
        for channel, blocks in self._index.items():
            places[channel] = self._offset
            entries = np.concatenate(blocks).tobytes()
            self._write(struct.pack("<BQHI", 7, 6 + len(entries), channel, len(entries)) + entries)
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
        self._new_chunk()

    def attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Write an attachment (with its own CRC)."""
        self._close_chunk()
        start = self._offset
        made = Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data)
        self._write(_packed(made))
        self._attachments.append(AttachmentIndex(start, self._offset - start, 0, 0, len(data), name, media_type))

    def metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        self._close_chunk()
        start = self._offset
        self._write(_packed(Metadata(name=name, metadata=dict(values))))
        self._metadata.append(MetadataIndex(start, self._offset - start, name))

    def finish(self) -> None:
        """Close the last chunk and write the summary section."""
        self._close_chunk()
        self._write(_packed(DataEnd(self._crc)))
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            message_end_time=self._last,
            message_start_time=self._first or 0,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
        groups = [
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
