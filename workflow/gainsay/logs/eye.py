"""Where the camera of a scene stands."""

import math
from collections.abc import Iterator
from typing import Any

from gainsay.logs.layout import Scene
from gainsay.logs.reader import Log

_DIRECTION = (0.64, -0.62, 0.46)  # a little off the diagonal, so that no two axes fall onto each other


def eye_of(scene: Scene, log: Log) -> tuple[float, float, float]:
    """Place of the camera in the frame of the scene, m: as declared, or so far off that all that is drawn is seen."""
    if scene.eye is not None:
        return scene.eye
    shift = _shifts(log)
    reach = 0.0
    for topic in scene.topics:
        for _, message in log.messages(topic)[:1]:
            for entity in message.entities:
                extent = max((math.hypot(*point) for point in _points(entity)), default=0.0)
                moves = entity.frame_id not in (scene.frame, scene.follow)
                reach = max(reach, extent + (shift.get(entity.frame_id, 0.0) if moves else 0.0))
    x, y, z = (1.7 * (reach or 1.0) * part for part in _DIRECTION)
    return x, y, z


def _shifts(log: Log) -> dict[str, float]:
    """Farthest that each frame goes from its parent, m."""
    found: dict[str, float] = {}
    for topic in log.topics:
        if log.kind(topic) == "transforms":
            for _, message in log.messages(topic):
                for turn in message.transforms:
                    away = math.hypot(turn.translation.x, turn.translation.y, turn.translation.z)
                    found[turn.child_frame_id] = max(found.get(turn.child_frame_id, 0.0), away)
    return found


def _points(entity: Any) -> Iterator[tuple[float, float, float]]:
    """Points that an entity reaches."""
    for drawn in (*entity.lines, *entity.triangles):
        yield from ((point.x, point.y, point.z) for point in drawn.points)
    for arrow in entity.arrows:
        place = arrow.pose.position
        yield (math.hypot(place.x, place.y, place.z) + arrow.shaft_length + arrow.head_length, 0.0, 0.0)
    for solid in (*entity.cubes, *entity.spheres):
        place = solid.pose.position
        yield (abs(place.x) + solid.size.x / 2, abs(place.y) + solid.size.y / 2, abs(place.z) + solid.size.z / 2)
