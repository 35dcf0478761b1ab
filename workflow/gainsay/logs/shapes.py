"""Scene elements of a log with their points, each read once for all that looks at them: drawings and cameras."""

from typing import Any, NamedTuple

import numpy as np

from gainsay.logs.reader import Log


class Shape(NamedTuple):
    """An entity of a scene element at one time.

    Attributes
    ----------
    entity : SceneEntity
        As Foxglove-compatible viewers draw it.
    lines, triangles : list of (N, 3) arrays
        Points of its lines, and corners of the triangles of its plates, m.
    """

    entity: Any
    lines: list[np.ndarray]
    triangles: list[np.ndarray]


class Shapes:
    """What a log draws, by the topic of the scene element.

    Parameters
    ----------
    log : Log
    """

    def __init__(self, log: Log) -> None:
        self.log = log
        self._read: dict[str, list[tuple[float, list[Shape]]]] = {}

    def __getitem__(self, topic: str) -> list[tuple[float, list[Shape]]]:
        """Return the shapes of a scene element at each of its times, s."""
        if topic not in self._read:
            self._read[topic] = [
                (time, [_shape(entity) for entity in message.entities]) for time, message in self.log.messages(topic)
            ]
        return self._read[topic]


def _shape(entity: Any) -> Shape:
    return Shape(entity, [_points(line) for line in entity.lines], [_points(plate) for plate in entity.triangles])


def _points(part: Any) -> np.ndarray:
    return np.array([(point.x, point.y, point.z) for point in part.points]).reshape(-1, 3)
