"""What can be told of an MCAP file that is not one of ours: read as far as it can be, nothing is concluded from it."""

from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Header, Message
from mcap.stream_reader import StreamReader, lz4

from gainsay.errors import LogError, one_line
from gainsay.logs.container import LARGEST_CHUNK, PROFILE
from gainsay.logs.reader import read_log
from gainsay.logs.records import Place
from gainsay.logs.records import records as records_in
from gainsay.tables.files import open_regular


def describe(path: Path) -> Iterator[str]:
    """Yield lines on a single file: whose it is, then its topics with their encoding and number of messages.

    Raises
    ------
    InputError
        The file is missing or none.
    LogError
        It is no MCAP file, or one of ours and damaged.
    """
    with open_regular(path) as stream:
        records = StreamReader(stream, emit_chunks=True, record_size_limit=LARGEST_CHUNK).records
        header = _header(path, records)
        if header.profile != PROFILE:
            yield from _foreign(path, header, records)
            return
    log = read_log(path)
    yield f"{path.name}: {log.metadata.get('paper', '')} {log.metadata.get('run', '')}, {log.duration:g} s"
    yield from (f"  {topic}  {log.count(topic)} messages" for topic in log.topics)


def _header(path: Path, records: Iterator[object]) -> Header:
    try:
        header = next((record for record in records if isinstance(record, Header)), None)
    except Exception as error:  # what is no MCAP file may break its reader in any way
        raise LogError(f"no MCAP file: {one_line(str(error)) or type(error).__name__}", file=path.name) from None
    if header is None:
        raise LogError("no MCAP file", file=path.name)
    return header


def _unpacked(record: object, where: Place) -> Iterator[object]:
    """Channels and messages of a chunk, which may not unpack to more than we hold; any other record itself."""
    if not isinstance(record, Chunk):
        yield record
        return
    data = record.data
    if record.compression == "zstd":
        data = zstandard.ZstdDecompressor().stream_reader(data).read(LARGEST_CHUNK + 1)
    elif record.compression == "lz4":
        data = lz4.LZ4FrameDecompressor().decompress(data, max_length=LARGEST_CHUNK + 1)
    if len(data) > LARGEST_CHUNK:
        raise ValueError(f"a chunk of more than {LARGEST_CHUNK} bytes")
    for opcode, _, start, end in records_in(data, 0, len(data), where):
        content = ReadDataStream(BytesIO(data[start:end]))
        if opcode == Opcode.CHANNEL:
            yield Channel.read(content)
        elif opcode == Opcode.MESSAGE:
            yield Message.read(content, end - start)


def _foreign(path: Path, header: Header, records: Iterator[object]) -> Iterator[str]:
    channels: dict[int, Channel] = {}
    counts: Counter[int] = Counter()
    first: int | None = None
    last = 0
    broken = ""
    try:
        for record in (inner for outer in records for inner in _unpacked(outer, Place(path.name))):
            if isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                counts[record.channel_id] += 1
                first = record.log_time if first is None else min(first, record.log_time)
                last = max(last, record.log_time)
    except Exception as error:  # a file of somebody else may break any reader; what was read before that is told
        broken = f"; it breaks off: {one_line(str(error)) or type(error).__name__}"
    duration = 0.0 if first is None else (last - first) / 1e9
    yield (
        f"{path.name}: not one of ours (profile {header.profile!r}, written by {header.library!r}): "
        f"{sum(counts.values())} messages in {duration:g} s{broken}"
    )
    for channel in channels.values():
        yield one_line(f"  {channel.topic}  {channel.message_encoding}  {counts[channel.id]} messages")
