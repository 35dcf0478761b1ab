"""Blocks of ``foxglove.FrameTransforms`` messages, encoded as one array."""

import numpy as np

from gainsay.errors import InputError


def _varint5(values: np.ndarray) -> np.ndarray:
    """Encode integers below 2**35 as protobuf varints padded to five bytes, so that all are equally long."""
    shifted = values.astype(np.uint64)[:, None] >> np.arange(0, 35, 7, dtype=np.uint64)
    return (shifted & np.uint64(0x7F)).astype(np.uint8) | np.array([0x80] * 4 + [0], dtype=np.uint8)


def transform_block(parent: str, child: str, moments: np.ndarray, shift: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Lay out complete message records, one transform each, for `Container.records`.

    Parameters
    ----------
    parent, child : str
        Frames, at most 60 letters each.
    moments : (N,) ndarray of uint64
        Nanoseconds.
    shift : (N, 3) ndarray
        Translation, m.
    turn : (N, 4) ndarray
        Quaternion x, y, z, w.
    """
    if len(parent) > 60 or len(child) > 60:
        raise InputError("frames", value=(parent, child), expected="names of at most 60 letters")
    names = b"".join(bytes([tag, len(text)]) + text.encode() for tag, text in ((0x12, parent), (0x1A, child)))
    inner = 2 + 12 + len(names) + 2 + 27 + 2 + 36
    length = bytes([inner]) if inner < 128 else bytes([inner & 0x7F | 0x80, inner >> 7])
    # In wire order: strings are constants, times padded varints, numbers 64 bit, so all records are equally long.
    parts: list[tuple[str, str, object]] = [
        ("opcode", "u1", 5),
        ("length", "<u8", 22 + 1 + len(length) + inner),
        ("channel", "<u2", 0),
        ("sequence", "<u4", 0),
        ("log_time", "<u8", moments),
        ("publish_time", "<u8", moments),
        ("opening", f"V{4 + len(length)}", np.void(b"\x0a" + length + b"\x0a\x0c\x08")),
        ("seconds", "5u1", _varint5(moments // np.uint64(10**9))),
        ("tag", "u1", 0x10),
        ("nanos", "5u1", _varint5(moments % np.uint64(10**9))),
        ("names", f"V{len(names)}", np.void(names)),
        ("moved", "V2", np.void(b"\x22\x1b")),
    ]
    for axis in range(3):
        parts += [(f"s{axis}", "u1", axis + 1 << 3 | 1), (f"x{axis}", "<f8", shift[:, axis])]
    parts.append(("turned", "V2", np.void(b"\x2a\x24")))
    for axis in range(4):
        parts += [(f"q{axis}", "u1", axis + 1 << 3 | 1), (f"r{axis}", "<f8", turn[:, axis])]
    block = np.empty(len(moments), dtype=np.dtype([(name, kind) for name, kind, _ in parts]))
    for name, _, value in parts:
        block[name] = value
    return block
