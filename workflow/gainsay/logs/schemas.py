"""Message types of a log, as protobuf descriptors built at run time.

A signal has a flat message type of its own: the field ``time`` and one double for each component. The types that
viewers know are those of the Foxglove schema set (https://docs.foxglove.dev/docs/visualization/message-schemas/):
their names and field numbers are part of the wire format and are restated here.
"""

import re
from functools import cache
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from gainsay.errors import InputError

_FIELD = descriptor_pb2.FieldDescriptorProto
_TOPIC = re.compile(r"(/[A-Za-z][A-Za-z0-9_]*)+")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
PACKAGE = "gainsay"

# file -> messages; "name:number:type", a leading * for repeated; an enum is "Name=A,B,.." counted from 0.
_FOXGLOVE = {
    "google/protobuf/timestamp.proto": {"Timestamp": "seconds:1:int64 nanos:2:int32"},
    "google/protobuf/duration.proto": {"Duration": "seconds:1:int64 nanos:2:int32"},
    "foxglove/Color.proto": {"Color": "r:1:double g:2:double b:3:double a:4:double"},
    "foxglove/Vector3.proto": {"Vector3": "x:1:double y:2:double z:3:double"},
    "foxglove/Point3.proto": {"Point3": "x:1:double y:2:double z:3:double"},
    "foxglove/Quaternion.proto": {"Quaternion": "x:1:double y:2:double z:3:double w:4:double"},
    "foxglove/KeyValuePair.proto": {"KeyValuePair": "key:1:string value:2:string"},
    "foxglove/Pose.proto": {"Pose": "position:1:Vector3 orientation:2:Quaternion"},
    "foxglove/Log.proto": {
        "Log": "timestamp:1:Timestamp level:2:Level message:3:string name:4:string file:5:string line:6:fixed32 "
        "Level=UNKNOWN,DEBUG,INFO,WARNING,ERROR,FATAL"
    },
    "foxglove/FrameTransform.proto": {
        "FrameTransform": "timestamp:1:Timestamp parent_frame_id:2:string child_frame_id:3:string "
        "translation:4:Vector3 rotation:5:Quaternion"
    },
    "foxglove/FrameTransforms.proto": {"FrameTransforms": "*transforms:1:FrameTransform"},
    "foxglove/ArrowPrimitive.proto": {
        "ArrowPrimitive": "pose:1:Pose shaft_length:2:double shaft_diameter:3:double head_length:4:double "
        "head_diameter:5:double color:6:Color"
    },
    "foxglove/CubePrimitive.proto": {"CubePrimitive": "pose:1:Pose size:2:Vector3 color:3:Color"},
    "foxglove/SpherePrimitive.proto": {"SpherePrimitive": "pose:1:Pose size:2:Vector3 color:3:Color"},
    "foxglove/CylinderPrimitive.proto": {
        "CylinderPrimitive": "pose:1:Pose size:2:Vector3 bottom_scale:3:double top_scale:4:double color:5:Color"
    },
    "foxglove/LinePrimitive.proto": {
        "LinePrimitive": "type:1:Type pose:2:Pose thickness:3:double scale_invariant:4:bool *points:5:Point3 "
        "color:6:Color *colors:7:Color *indices:8:fixed32 Type=LINE_STRIP,LINE_LOOP,LINE_LIST"
    },
    "foxglove/TriangleListPrimitive.proto": {
        "TriangleListPrimitive": "pose:1:Pose *points:2:Point3 color:3:Color *colors:4:Color *indices:5:fixed32"
    },
    "foxglove/TextPrimitive.proto": {
        "TextPrimitive": "pose:1:Pose billboard:2:bool font_size:3:double scale_invariant:4:bool color:5:Color "
        "text:6:string"
    },
    "foxglove/ModelPrimitive.proto": {
        "ModelPrimitive": "pose:1:Pose scale:2:Vector3 color:3:Color override_color:4:bool url:5:string "
        "media_type:6:string data:7:bytes"
    },
    "foxglove/SceneEntityDeletion.proto": {
        "SceneEntityDeletion": "timestamp:1:Timestamp type:2:Type id:3:string Type=MATCHING_ID,ALL"
    },
    "foxglove/SceneEntity.proto": {
        "SceneEntity": "timestamp:1:Timestamp frame_id:2:string id:3:string lifetime:4:Duration frame_locked:5:bool "
        "*metadata:6:KeyValuePair *arrows:7:ArrowPrimitive *cubes:8:CubePrimitive *spheres:9:SpherePrimitive "
        "*cylinders:10:CylinderPrimitive *lines:11:LinePrimitive *triangles:12:TriangleListPrimitive "
        "*texts:13:TextPrimitive *models:14:ModelPrimitive"
    },
    "foxglove/SceneUpdate.proto": {"SceneUpdate": "*deletions:1:SceneEntityDeletion *entities:2:SceneEntity"},
}
_HOME = {message: file for file, messages in _FOXGLOVE.items() for message in messages}


def _full_name(message: str) -> str:
    return _HOME[message].rsplit("/", 1)[0].replace("/", ".") + "." + message


def _file(name: str) -> descriptor_pb2.FileDescriptorProto:
    """Build the descriptor of one file of the table above."""
    file = descriptor_pb2.FileDescriptorProto(name=name, package=name.rsplit("/", 1)[0].replace("/", "."))
    file.syntax = "proto3"
    imports = set()
    for message, text in _FOXGLOVE[name].items():
        into = file.message_type.add(name=message)
        enums = {}
        for word in text.split():
            if "=" in word:
                enum, members = word.split("=")
                enums[enum] = into.enum_type.add(name=enum)
                for value, member in enumerate(members.split(",")):
                    enums[enum].value.add(name=member, number=value)
        for word in text.split():
            if "=" in word:
                continue
            field, number, kind = word.lstrip("*").split(":")
            label = _FIELD.LABEL_REPEATED if word.startswith("*") else _FIELD.LABEL_OPTIONAL
            made = into.field.add(name=field, number=int(number), label=label)
            if kind in enums:
                made.type, made.type_name = _FIELD.TYPE_ENUM, f".{file.package}.{message}.{kind}"
            elif kind in _HOME:
                made.type, made.type_name = _FIELD.TYPE_MESSAGE, "." + _full_name(kind)
                imports.add(_HOME[kind])
            else:
                made.type = getattr(_FIELD, "TYPE_" + kind.upper())
    file.dependency.extend(sorted(imports))
    return file


@cache
def _pool() -> descriptor_pool.DescriptorPool:
    pool = descriptor_pool.DescriptorPool()
    for name in _FOXGLOVE:
        pool.Add(_file(name))
    return pool


@cache
def foxglove_class(message: str) -> Any:
    """Protobuf class of a well-known message, e.g. ``foxglove_class("SceneUpdate")``."""
    return message_factory.GetMessageClass(_pool().FindMessageTypeByName(_full_name(message)))


@cache
def foxglove_schema(message: str) -> tuple[str, bytes]:
    """Full name and serialized FileDescriptorSet (imports first) of a well-known message."""
    order: list[str] = []

    def visit(name: str) -> None:
        for other in _file(name).dependency:
            visit(other)
        if name not in order:
            order.append(name)

    visit(_HOME[message])
    files = descriptor_pb2.FileDescriptorSet(file=[_file(name) for name in order])
    return _full_name(message), files.SerializeToString(deterministic=True)


def check_topic(topic: str) -> str:
    """Return `topic` if it is of the form ``/name/name``, else raise InputError."""
    if not _TOPIC.fullmatch(topic):
        raise InputError("topic", value=topic, expected="/name/name of letters, digits and underscores")
    return topic


def check_name(name: str, what: str) -> str:
    """Return `name` if it is an identifier, else raise InputError naming `what`."""
    if not _NAME.fullmatch(name):
        raise InputError(what, value=name, expected="a letter, then letters, digits and underscores")
    return name


def signal_schema(topic: str, fields: tuple[str, ...]) -> tuple[str, bytes]:
    """Full name and serialized FileDescriptorSet of the flat message type of a signal.

    Parameters
    ----------
    topic : str
        ``/chaser/state`` becomes message ``gainsay.chaser.state``.
    fields : tuple of str
        Names of the components; the exact time in seconds is field 1, they follow from 2.
    """
    *folders, name = topic.strip("/").split("/")
    package = ".".join((PACKAGE, *folders))
    file = descriptor_pb2.FileDescriptorProto(name=topic.strip("/") + ".proto", package=package, syntax="proto3")
    message = file.message_type.add(name=name)
    for number, field in enumerate(("time", *fields), start=1):
        message.field.add(name=field, number=number, type=_FIELD.TYPE_DOUBLE, label=_FIELD.LABEL_OPTIONAL)
    files = descriptor_pb2.FileDescriptorSet(file=[file])
    return f"{package}.{name}", files.SerializeToString(deterministic=True)


def signal_record(count: int) -> tuple[np.dtype, list[tuple[str, int]]]:
    """Layout of one MCAP message record that holds `count` doubles (the time included).

    All fields are fixed 64 bit, so every record of a topic has the same length and a block of them is one array.

    Returns
    -------
    dtype : numpy.dtype
        Packed: opcode, length, channel, sequence, log_time, publish_time, then tag ``t1`` and double ``v1``, ...
    constants : list of (str, int)
        The parts with a fixed content (opcode, record length and protobuf tags) and that content.
    """
    names = ["opcode", "length", "channel", "sequence", "log_time", "publish_time"]
    formats = ["u1", "<u8", "<u2", "<u4", "<u8", "<u8"]
    constants = [("opcode", 5)]
    for number in range(1, count + 1):
        tag = number << 3 | 1  # wire type 1: 64 bit
        wide = tag >= 0x80
        if number >= 1 << 11:
            raise InputError("components of a signal", value=count, expected="at most 2046")
        constants.append((f"t{number}", (tag & 0x7F | 0x80) | (tag >> 7) << 8 if wide else tag))
        names += [f"t{number}", f"v{number}"]
        formats += ["<u2" if wide else "u1", "<f8"]
    dtype = np.dtype(list(zip(names, formats, strict=True)))
    constants.insert(1, ("length", dtype.itemsize - 9))
    return dtype, constants
