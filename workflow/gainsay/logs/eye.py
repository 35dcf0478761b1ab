"""Where the camera of a scene stands."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from gainsay.logs.layout import Layout, Scene
from gainsay.logs.reader import Log
from gainsay.logs.shapes import Shape, Shapes

#: half the angle that a square picture shows, rad: a little less than the narrower of the viewers' own
_HALF_ANGLE = 0.38
#: where a ball of radius one meets the axes
_AXES = np.concatenate([np.eye(3), -np.eye(3)])


class Eye(NamedTuple):
    """Place of the camera and the point it looks at, m, in the frame of the scene."""

    place: tuple[float, float, float]
    target: tuple[float, float, float]


def eyes_of(layout: Layout, shapes: Shapes) -> Mapping[Scene, Eye]:
    """Return the camera of every scene of a layout: each looks at all that is drawn, which is done once for a log."""
    return {panel: eye_of(panel, shapes) for panel in layout.panels() if isinstance(panel, Scene)}


def eye_of(scene: Scene, shapes: Shapes) -> Eye:
    """Return a camera that sees all that is drawn at any time.

    It looks at the middle of the box around everything, or at the frame that it follows.
    """
    reached: dict[str, list[np.ndarray]] = {}
    for topic in scene.topics:
        for _, drawn in shapes[topic]:
            for shape in drawn:
                reached.setdefault(shape.entity.frame_id, []).extend(_points(shape))
    shifts = _shifts(shapes.log)
    clouds = [np.zeros((1, 3))]
    for frame, points in reached.items():
        still = frame not in shifts or frame in (scene.frame, scene.follow)
        places = np.zeros((1, 3)) if still else shifts[frame]
        clouds.append((np.concatenate([np.zeros((0, 3)), *points]) + places[:, None]).reshape(-1, 3))
    around = np.concatenate(clouds)
    low, high = around.min(axis=0), around.max(axis=0)
    middle = np.zeros(3) if scene.follow else 0.5 * (low + high)
    reach = float(np.linalg.norm(around - middle, axis=1).max()) or 1.0
    direction = np.array(scene.direction) / np.linalg.norm(scene.direction)
    place = middle + reach / np.sin(_HALF_ANGLE) * direction
    return Eye(tuple(place.tolist()), tuple(middle.tolist()))


def _shifts(log: Log) -> dict[str, np.ndarray]:
    """Places (N, 3) of the origin of each frame in its parent at the corners of the box that it moves in, m."""
    return {
        frame: places[np.unique([*places.argmin(axis=0), *places.argmax(axis=0)])]
        for frame, (_, places) in log.transforms.items()
    }


def _points(shape: Shape) -> Iterator[np.ndarray]:
    """Points (N, 3) that a shape reaches: those of a ball around an arrow or a solid, since its frame may turn."""
    yield from shape.lines
    yield from shape.triangles
    for arrow in shape.entity.arrows:
        yield _ball(arrow.pose.position, arrow.shaft_length + arrow.head_length)
    for solid in (*shape.entity.cubes, *shape.entity.spheres):
        yield _ball(solid.pose.position, 0.5 * max(solid.size.x, solid.size.y, solid.size.z))


def _ball(place: Any, radius: float) -> np.ndarray:
    return np.array([place.x, place.y, place.z]) + radius * _AXES
