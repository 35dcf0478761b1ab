"""Where the camera of a scene stands."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from gainsay.logs.layout import Layout, Scene
from gainsay.logs.reader import Log

#: half the angle that a square picture shows, rad: a little less than the narrower of the viewers' own
_HALF_ANGLE = 0.38


class Eye(NamedTuple):
    """Place of the camera and the point it looks at, m, in the frame of the scene."""

    place: tuple[float, float, float]
    target: tuple[float, float, float]


def eyes_of(layout: Layout, log: Log) -> Mapping[Scene, Eye]:
    """Return the camera of every scene of a layout: each looks at all that is drawn, which is done once for a log."""
    return {panel: eye_of(panel, log) for panel in layout.panels() if isinstance(panel, Scene)}


def eye_of(scene: Scene, log: Log) -> Eye:
    """Return a camera that sees all that is drawn at any time.

    It looks at the middle of the box around everything, or at the frame that it follows.
    """
    shifts = _shifts(log)
    points = []
    for topic in scene.topics:
        for _, message in log.messages(topic):
            for entity in message.entities:
                own_points = np.array(list(_points(entity))).reshape(-1, 3)
                moved = shifts.get(entity.frame_id) if entity.frame_id not in (scene.frame, scene.follow) else None
                points += [own_points] if moved is None else [own_points + low_or_high for low_or_high in moved]
    around = np.concatenate([np.zeros((1, 3)), *points])
    low, high = around.min(axis=0), around.max(axis=0)
    middle = np.zeros(3) if scene.follow else 0.5 * (low + high)
    reach = float(np.linalg.norm(around - middle, axis=1).max()) or 1.0
    direction = np.array(scene.direction) / np.linalg.norm(scene.direction)
    place = middle + reach / np.sin(_HALF_ANGLE) * direction
    return Eye(tuple(place.tolist()), tuple(middle.tolist()))


def _shifts(log: Log) -> dict[str, np.ndarray]:
    """Places (N, 3) of the origin of each frame in its parent at the corners of the box that it moves in, m."""
    shifts: dict[str, np.ndarray] = {}
    for topic in log.topics:
        if log.kind(topic) == "transforms":
            moved: dict[str, list[tuple[float, float, float]]] = {}
            for _, message in log.messages(topic):
                for turn in message.transforms:
                    place = (turn.translation.x, turn.translation.y, turn.translation.z)
                    moved.setdefault(turn.child_frame_id, []).append(place)
            for frame, places in moved.items():
                every = np.array(places)
                rows = np.unique([*every.argmin(axis=0), *every.argmax(axis=0)])
                shifts[frame] = every[rows]
    return shifts


def _points(entity: Any) -> Iterator[tuple[float, float, float]]:
    """Points that an entity reaches: those of a ball around an arrow or a solid, since its frame may turn."""
    for own_points in (*entity.lines, *entity.triangles):
        yield from ((point.x, point.y, point.z) for point in own_points.points)
    for arrow in entity.arrows:
        place, length = arrow.pose.position, arrow.shaft_length + arrow.head_length
        yield from _ball(place, length)
    for solid in (*entity.cubes, *entity.spheres):
        yield from _ball(solid.pose.position, 0.5 * max(solid.size.x, solid.size.y, solid.size.z))


def _ball(place: Any, radius: float) -> Iterator[tuple[float, float, float]]:
    for sign in (-radius, radius):
        yield place.x + sign, place.y, place.z
        yield place.x, place.y + sign, place.z
        yield place.x, place.y, place.z + sign
