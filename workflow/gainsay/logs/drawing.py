"""Scene elements of a log as Rerun drawings: the same entities that Foxglove-compatible viewers draw.

Imports rerun (2 s): only `gainsay.logs.views` and what stands above it may import this module.
"""

from typing import Any

import numpy as np
import rerun as rr

from gainsay.logs.layout import Layout, Text
from gainsay.logs.shapes import Shape, Shapes

TIMELINE = "message_log_time"
_CUBE_FACES = [(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)]


def text_path(title: str) -> str:
    """Entity that holds the text page `title`."""
    return "/text/" + "".join(letter if letter.isalnum() else "_" for letter in title.lower())


def draw(layout: Layout, shapes: Shapes, stream: rr.RecordingStream) -> None:
    """Log every scene element and every text page of a run to a Rerun stream.

    An element that never changes is drawn at all times.
    """
    for topic in shapes.log.topics:
        if shapes.log.kind(topic) != "scene":
            continue
        static = len(shapes[topic]) == 1 and shapes[topic][0][0] == 0.0
        solids: dict[str, bytes] = {}
        plates, arrows = _Plates(stream, topic), _Arrows(stream, topic)
        for time, drawn in shapes[topic]:
            moment = np.timedelta64(round(time * 1e9), "ns")
            if not static:
                stream.set_time(TIMELINE, duration=moment)
            for shape in drawn:
                entity = shape.entity
                _draw_shape(stream, topic, shape, static, solids, plates, moment)
                if entity.arrows or not (entity.lines or entity.cubes or entity.spheres or entity.triangles):
                    arrows.add(entity, moment)
        plates.send()
        arrows.send(static)
    for panel in layout.panels():
        if isinstance(panel, Text):
            page = rr.TextDocument(panel.markdown, media_type=rr.MediaType.MARKDOWN)
            stream.log(text_path(panel.title), page, static=True)


class _Plates:
    """Plates of one topic: each is drawn whole at first, then by its shape alone, all times in one call."""

    def __init__(self, stream: rr.RecordingStream, topic: str) -> None:
        self._stream, self._topic = stream, topic
        self._looks: dict[str, tuple[str, int, list[int]]] = {}
        self._bent: dict[str, list[tuple[np.timedelta64, np.ndarray]]] = {}

    def bends(self, part: str, frame: str, mesh: Any, corners: np.ndarray, moment: np.timedelta64) -> bool:
        """Keep the shape of a plate that is as it was but for its shape; say whether it is such a one."""
        before, self._looks[part] = self._looks.get(part), (frame, len(corners), _colour(mesh.color))
        if before != self._looks[part]:
            return False
        self._bent.setdefault(part, []).append((moment, corners))
        return True

    def send(self) -> None:
        """Log the shapes that were kept, each at its time."""
        for part, kept in self._bent.items():
            corners = np.concatenate([corners for _, corners in kept])
            shapes = rr.Mesh3D.columns(vertex_positions=corners, vertex_normals=_normals(corners))
            self._stream.send_columns(
                f"{self._topic}/{part}",
                indexes=[rr.TimeColumn(TIMELINE, duration=np.array([moment for moment, _ in kept]))],
                columns=shapes.partition([len(corners) for _, corners in kept]),
            )


class _Arrows:
    """Arrows of one topic, those of all times in one call; a time without any clears those before it."""

    def __init__(self, stream: rr.RecordingStream, topic: str) -> None:
        self._stream, self._path = stream, f"{topic}/arrows"
        self._kept: list[tuple[np.timedelta64, Any]] = []

    def add(self, entity: Any, moment: np.timedelta64) -> None:
        """Keep the arrows of an entity at a time."""
        self._kept.append((moment, entity))

    def send(self, static: bool) -> None:
        """Log what was kept, each at its time or at all times."""
        if not self._kept:
            return
        arrows = [arrow for _, entity in self._kept for arrow in entity.arrows]
        columns = rr.Arrows3D.columns(
            origins=np.array([_triple(arrow.pose.position) for arrow in arrows]).reshape(-1, 3),
            vectors=np.array(
                [_turned(arrow.pose.orientation, arrow.shaft_length + arrow.head_length) for arrow in arrows]
            ).reshape(-1, 3),
            radii=[0.5 * arrow.shaft_diameter for arrow in arrows],
            colors=[_colour(arrow.color) for arrow in arrows],
        )
        times = [] if static else [rr.TimeColumn(TIMELINE, duration=np.array([moment for moment, _ in self._kept]))]
        frames = rr.CoordinateFrame.columns(frame=[entity.frame_id for _, entity in self._kept])
        parts = columns.partition([len(entity.arrows) for _, entity in self._kept])
        self._stream.send_columns(self._path, indexes=times, columns=[*frames, *parts])


def _draw_shape(
    stream: rr.RecordingStream,
    topic: str,
    shape: Shape,
    static: bool,
    solids: dict[str, bytes],
    plates: _Plates,
    moment: np.timedelta64,
) -> None:
    """Draw a shape; a solid that is as it was at the time before, in its own frame, stands as it is."""
    entity = shape.entity

    def new(part: str, solid: Any) -> bool:
        before, solids[part] = solids.get(part), solid.SerializeToString()
        return before != solids[part]

    def put(part: str, drawing: rr.AsComponents) -> None:
        stream.log(f"{topic}/{part}", rr.CoordinateFrame(entity.frame_id), drawing, static=static)

    for number, (line, points) in enumerate(zip(entity.lines, shape.lines, strict=True)):
        width = rr.Radius.ui_points(0.5 * line.thickness) if line.scale_invariant else 0.5 * line.thickness
        put(f"line{number}", rr.LineStrips3D([points], radii=width, colors=[_colour(line.color)]))
    for number, cube in enumerate(entity.cubes):
        if new(f"cube{number}", cube):
            put(f"cube{number}", _cube(cube))
    for number, (mesh, corners) in enumerate(zip(entity.triangles, shape.triangles, strict=True)):
        if new(f"plate{number}", mesh) and not plates.bends(f"plate{number}", entity.frame_id, mesh, corners, moment):
            put(f"plate{number}", _mesh(corners, mesh.color))
    if entity.spheres:
        balls = rr.Points3D(
            [_triple(ball.pose.position) for ball in entity.spheres],
            radii=[0.5 * ball.size.x for ball in entity.spheres],
            colors=[_colour(ball.color) for ball in entity.spheres],
        )
        put("balls", balls)
    if topic.startswith("/scene/axes_"):
        put("origin", rr.Points3D([(0.0, 0.0, 0.0)], radii=rr.Radius.ui_points(0.0)))  # what a camera can follow
    if entity.texts:
        labels = rr.Points3D(
            [_triple(text.pose.position) for text in entity.texts],
            radii=rr.Radius.ui_points(0.0),
            labels=[text.text for text in entity.texts],
            colors=[_colour(text.color) for text in entity.texts],
            show_labels=True,
        )
        put("labels", labels)


def _triple(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


def _colour(colour: Any) -> list[int]:
    return [round(255 * part) for part in (colour.r, colour.g, colour.b, colour.a)]


def _turned(quaternion: Any, length: float) -> list[float]:
    """Vector of `length` along the x axis, turned by a unit quaternion."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    return [
        length * (1.0 - 2.0 * (y * y + z * z)),
        length * 2.0 * (x * y + w * z),
        length * 2.0 * (x * z - w * y),
    ]


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normal of its triangle at each corner; zero where a triangle has no area."""
    first, second, third = corners[0::3], corners[1::3], corners[2::3]
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.repeat(np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0), 3, axis=0)


def _mesh(corners: np.ndarray, colour: Any) -> rr.Mesh3D:
    """Triangles with the normals of their planes, so that light shows their shape."""
    return rr.Mesh3D(
        vertex_positions=corners,
        vertex_normals=_normals(corners),
        triangle_indices=np.arange(len(corners)).reshape(-1, 3),
        albedo_factor=_colour(colour),
    )


def _cube(cube: Any) -> rr.Mesh3D:
    half = 0.5 * np.array(_triple(cube.size))
    corners = []
    for axis, sign in _CUBE_FACES:
        normal, across = np.zeros(3), np.zeros(3)
        normal[axis], across[(axis + 1) % 3] = sign, 1.0
        up = np.cross(normal, across)
        a, b, c, d = (normal + i * across + j * up for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        corners += [a, b, c, a, c, d]
    return _mesh(np.array(corners) * half + np.array(_triple(cube.pose.position)), cube.color)
