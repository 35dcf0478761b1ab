"""Logs against plain mcap-python with protobuf: the same 2e5 samples of 12 doubles."""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gainsay.bench.measure import Row, paired
from gainsay.logs import LogWriter, read_log

_SAMPLES, _FIELDS = 200_000, tuple(f"x{i}" for i in range(12))


def _message_class() -> Any:
    """Return a protobuf message of twelve doubles, as a plain user of the library would define it."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file = descriptor_pb2.FileDescriptorProto(name="plain.proto", package="plain", syntax="proto3")
    message = file.message_type.add(name="Sample")
    for number, name in enumerate(_FIELDS, start=1):
        message.field.add(name=name, number=number, type=1, label=1)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("plain.Sample")), file


def _write_plain(path: Path, time: np.ndarray, values: np.ndarray) -> None:
    from google.protobuf import descriptor_pb2
    from mcap.writer import CompressionType, Writer

    sample, file = _message_class()
    descriptors = descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema("plain.Sample", "protobuf", descriptors)
        channel = writer.register_channel("/x", "protobuf", schema)
        for t, row in zip(time.tolist(), values.tolist(), strict=True):
            data = sample(**dict(zip(_FIELDS, row, strict=True))).SerializeToString()
            writer.add_message(channel, log_time=round(t * 1e9), publish_time=round(t * 1e9), data=data)
        writer.finish()


def _read_plain(path: Path) -> np.ndarray:
    from mcap.reader import make_reader

    sample, _ = _message_class()
    rows = []
    with path.open("rb") as stream:
        for _, _, message in make_reader(stream).iter_messages():
            decoded = sample.FromString(message.data)
            rows.append([getattr(decoded, name) for name in _FIELDS])
    return np.array(rows)


def rows() -> Iterator[Row]:
    """Measure writing and reading."""
    time = np.arange(_SAMPLES) * 1e-3
    values = np.random.default_rng(0).normal(size=(_SAMPLES, len(_FIELDS)))
    with tempfile.TemporaryDirectory() as folder:
        ours, plain = Path(folder, "ours.mcap"), Path(folder, "plain.mcap")

        def write() -> None:
            with LogWriter(ours, provenance={"run": "bench"}) as log:
                log.signal("/x", dict.fromkeys(_FIELDS, "1"), time, values)

        yield paired(
            "log: write 2e5 x 12 doubles",
            write,
            "plain mcap-python protobuf",
            lambda: _write_plain(plain, time, values),
            aim=0.5,
            runs=1,
        )
        read: list[np.ndarray] = []
        yield paired(
            "log: read them back to arrays",
            lambda: read.append(read_log(ours)["/x"].values),
            "plain mcap-python protobuf",
            lambda: read.append(_read_plain(plain)),
            aim=0.5,
            runs=1,
        )
        if not np.array_equal(read[0], read[1]):
            raise RuntimeError("the two logs do not hold the same doubles")
