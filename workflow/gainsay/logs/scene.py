"""Elements of a three-dimensional scene, as entities of ``foxglove.SceneUpdate``.

Viewers draw them; nothing is computed from them. Lengths are metres in the frame of the element.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.logs.palette import on_both
from gainsay.logs.schemas import check_name, foxglove_class

UPDATES = 400
"""Most updates drawn of a moving element; the exact numbers are in the signals."""
_SEGMENTS = 12
# corners of a plate's triangles, of its edges' points: left and right of a place, then those of the next
_TRIANGLES = [2 * i + corner for i in range(_SEGMENTS) for corner in (0, 1, 2, 2, 1, 3)]
_CANTILEVER = (1.8751040687119611, 4.694091132974175, 7.854757438237613, 10.995540734875467)


@dataclass(frozen=True)
class Appendage:
    """A flexible plate clamped to the body.

    Attributes
    ----------
    root, along, normal : tuple of 3 floats
        Clamped end, m; unit vectors along the plate and in the direction of its deflection.
    length, width : float
        m.
    tip : tuple of floats
        Deflection drawn at the tip, m, for one unit of each modal coordinate (exaggeration included). The shape drawn
        for mode j is the j-th clamped-free bending mode: an illustration, since papers give frequencies only.
    """

    root: tuple[float, float, float]
    along: tuple[float, float, float]
    normal: tuple[float, float, float]
    length: float
    width: float
    tip: tuple[float, ...] = ()


@dataclass(frozen=True)
class Body:
    """A box with flexible appendages.

    Attributes
    ----------
    size : tuple of 3 floats
        Edges along the axes of the body frame, m.
    appendages : tuple of Appendage
    """

    size: tuple[float, float, float]
    appendages: tuple[Appendage, ...] = ()


def chosen(count: int) -> list[int]:
    """Rows drawn of `count` samples: all, or `UPDATES` of them evenly spread with both ends."""
    if count <= UPDATES:
        return list(range(count))
    return sorted({round(step * (count - 1) / (UPDATES - 1)) for step in range(UPDATES)})


def bending_mode(number: int, along: np.ndarray) -> np.ndarray:
    """Clamped-free bending mode of a uniform beam, scaled to 1 at the tip.

    Parameters
    ----------
    number : int
        Counted from 0; modes above the fourth use the asymptotic wave number.
    along : (N,) ndarray
        Place on the beam, 0 at the clamp to 1 at the tip.

    Notes
    -----
    Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1.
    """
    wave = _CANTILEVER[number] if number < len(_CANTILEVER) else (number + 0.5) * math.pi
    sigma = (math.sinh(wave) - math.sin(wave)) / (math.cosh(wave) + math.cos(wave))

    def shape(x: np.ndarray | float) -> np.ndarray:
        return np.cosh(wave * x) - np.cos(wave * x) - sigma * (np.sinh(wave * x) - np.sin(wave * x))

    return shape(along) / shape(1.0)


def _entity(frame: str) -> Any:
    return foxglove_class("SceneEntity")(frame_id=check_name(frame, "frame"), frame_locked=True)


def _colour(into: Any, role: str, alpha: float = 1.0) -> None:
    into.r, into.g, into.b = (level / 255.0 for level in on_both(role))
    into.a = alpha


def _vector(into: Any, values: Any) -> None:
    into.x, into.y, into.z = (float(value) for value in values)


def _finite(values: object, shape: tuple[int | None, ...], what: str) -> np.ndarray:
    array = np.asarray(values, dtype=float)
    fits = array.ndim == len(shape) and all(w in (None, h) for w, h in zip(shape, array.shape, strict=True))
    if not fits or not np.isfinite(array).all():
        raise InputError(f"{what} of shape", value=array.shape, expected=f"finite, of shape {shape}")
    return array


def line(frame: str, points: object, role: str, width: float) -> Any:
    """Entity of a curve, `width` in pixels."""
    made = _entity(frame)
    strip = made.lines.add(thickness=width, scale_invariant=True)
    strip.pose.orientation.w = 1.0
    point = foxglove_class("Point3")
    strip.points.extend(point(x=x, y=y, z=z) for x, y, z in _finite(points, (None, 3), "points").tolist())
    _colour(strip.color, role)
    return made


def marker(frame: str, position: object, size: float, role: str, label: str) -> Any:
    """Entity of a ball and its label."""
    made = _entity(frame)
    place = _finite(position, (3,), "position")
    ball = made.spheres.add()
    _vector(ball.pose.position, place)
    ball.pose.orientation.w = 1.0
    _vector(ball.size, [size] * 3)
    _colour(ball.color, role)
    if label:
        _text(made, place + np.array([0.0, 0.0, size]), label, role, 14.0)
    return made


def _arrow(made: Any, origin: object, vector: np.ndarray, role: str) -> None:
    length = float(np.linalg.norm(vector))
    if length > 0.0:
        shape = made.arrows.add(
            shaft_length=0.8 * length,
            shaft_diameter=0.04 * length,
            head_length=0.2 * length,
            head_diameter=0.1 * length,
        )
        _vector(shape.pose.position, _finite(origin, (3,), "origin"))
        # Shortest rotation of the x axis onto the vector; half a turn about z where they are opposite.
        x, y, z = vector / length
        quaternion = np.array([0.0, -z, y, 1.0 + x]) if x > -1.0 + 1e-12 else np.array([0.0, 0.0, 1.0, 0.0])
        quaternion /= np.linalg.norm(quaternion)
        turn = shape.pose.orientation
        turn.x, turn.y, turn.z, turn.w = (float(value) for value in quaternion)
        _colour(shape.color, role)


def arrow(frame: str, origin: object, vector: np.ndarray, role: str) -> Any:
    """Entity of one arrow; a vector of length zero draws none."""
    made = _entity(frame)
    _arrow(made, origin, _finite(vector, (3,), "vector"), role)
    return made


def axes(frame: str, length: float, labels: tuple[str, str, str], name: str) -> Any:
    """Entity of the three axes of a frame, coloured as the components of vectors are; they are the scale too."""
    made = _entity(frame)
    for number, label in enumerate(labels):
        tip = np.zeros(3)
        tip[number] = float(length)
        _arrow(made, (0.0, 0.0, 0.0), tip, f"axis_{number + 1}")
        if label:
            _text(made, 1.08 * tip, label, f"axis_{number + 1}", 12.0)
    if name:
        _text(made, np.array([0.0, 0.0, -0.45 * length]), f"{name}, axes {_length(length)}", "body", 12.0)
    return made


def _length(length: float) -> str:
    return f"{length / 1e3:g} km" if length >= 1e3 else f"{length:g} m"


def _text(made: Any, place: np.ndarray, words: str, role: str, size: float) -> None:
    text = made.texts.add(billboard=True, font_size=size, scale_invariant=True, text=words)
    _vector(text.pose.position, place)
    text.pose.orientation.w = 1.0
    _colour(text.color, role)


@cache
def _outline(appendage: Appendage) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of a plate that does not change: its spine at rest, half its width, its normal, and its modes along it."""
    root, along, normal = (np.asarray(v, dtype=float) for v in (appendage.root, appendage.along, appendage.normal))
    across = np.cross(normal, along) * (0.5 * appendage.width)
    place = np.linspace(0.0, 1.0, _SEGMENTS + 1)
    modes = np.array([bending_mode(number, place) for number in range(len(appendage.tip))])
    return root + appendage.length * place[:, None] * along, across, normal, modes


def plate(appendage: Appendage, modal: np.ndarray) -> np.ndarray:
    """Points (26, 3) on the edges of a plate deflected by its modal coordinates, m: left and right of each place."""
    rest, across, normal, modes = _outline(appendage)
    rise = np.zeros(len(rest))
    for tip, coordinate, mode in zip(appendage.tip, modal, modes, strict=False):
        rise += tip * coordinate * mode
    spine = rest + rise[:, None] * normal
    return np.stack([spine + across, spine - across], axis=1).reshape(-1, 3)


def body(frame: str, shape: Body, modal: np.ndarray) -> Any:
    """Entity of a box with deflected plates."""
    made = _entity(frame)
    box = made.cubes.add()
    box.pose.orientation.w = 1.0
    _vector(box.size, _finite(shape.size, (3,), "size"))
    _colour(box.color, "body")
    point = foxglove_class("Point3")
    for appendage in shape.appendages:
        mesh = made.triangles.add()
        mesh.pose.orientation.w = 1.0
        edges = _finite(plate(appendage, modal), (None, 3), "plate")
        corners = [point(x=x, y=y, z=z) for x, y, z in edges.tolist()]
        mesh.points.extend([corners[k] for k in _TRIANGLES])
        _colour(mesh.color, "appendage")
    return made
