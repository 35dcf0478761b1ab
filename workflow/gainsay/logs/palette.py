"""Colours by role, the same in every viewer and every figure.

The hues are the colour-blind safe set of Okabe and Ito (2008); the first is darker and the third lighter than theirs,
so that the three axes stay apart under deuteranopia, protanopia, tritanopia and in grey print. A role names what a
curve *is*; nobody picks a colour by hand.
"""

import colorsys
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from gainsay.errors import InputError


@dataclass(frozen=True)
class Role:
    """The look of one role.

    Attributes
    ----------
    name : str
        Name of the role.
    meaning : str
        What a curve in this role is.
    on_light, on_dark : str
        Colour as ``#rrggbb`` on white paper and on the dark ground of the viewers.
    dash : str
        Line style in figures: ``solid``, ``dashed`` or ``dotted`` (viewers draw every line solid).
    width : float
        Line width relative to an ordinary curve.
    """

    name: str
    meaning: str
    on_light: str
    on_dark: str
    dash: str = "solid"
    width: float = 1.0


_ALL = (
    Role("axis_1", "first component: x, roll", "#004c80", "#2f7fc4"),
    Role("axis_2", "second component: y, pitch", "#d55e00", "#f07f2e"),
    Role("axis_3", "third component: z, yaw", "#14b085", "#5fe3bd"),
    Role("axis_4", "fourth component: scalar part of a quaternion", "#cc79a7", "#e09bc4"),
    Role("axis_1_estimate", "estimate of the first component", "#7db8dd", "#a9d6f5", "dashed", 0.35),
    Role("axis_2_estimate", "estimate of the second component", "#eeb184", "#f9c9a2", "dashed", 0.35),
    Role("axis_3_estimate", "estimate of the third component", "#7fd0b8", "#a6ebd6", "dashed", 0.35),
    Role("truth", "true state", "#1f1f1f", "#f0f0f0"),
    Role("estimate", "observer's estimate", "#e69f00", "#ffc23d", "dashed", 0.35),
    Role("magnitude", "Euclidean norm of a vector", "#1f1f1f", "#f0f0f0"),
    Role("nominal", "nominal plant", "#004c80", "#2f7fc4"),
    Role("perturbed", "perturbed plant", "#d55e00", "#f07f2e"),
    Role("comparison", "the design compared against", "#cc79a7", "#e09bc4", "dotted", 1.2),
    Role("bound", "a bound that the paper states", "#8c1d18", "#f2554d", "dashed", 0.8),
    Role("body", "spacecraft body", "#8a8f98", "#a8adb7"),
    Role("appendage", "flexible appendage", "#33508f", "#6f8fdc"),
    Role("thrust", "thrust or control torque", "#e69f00", "#ffc23d"),
    Role("target", "target or origin", "#cc79a7", "#e09bc4"),
)

ROLES = MappingProxyType({role.name: role for role in _ALL})
"""Every role by name (read only)."""


def role(name: str) -> Role:
    """Return the role `name`.

    Raises
    ------
    InputError
        There is no such role.
    """
    try:
        return ROLES[name]
    except KeyError:
        raise InputError("no such colour role", value=name, expected="one of " + ", ".join(ROLES)) from None


def _linear(level: int) -> float:
    part = level / 255.0
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


@cache
def on_both(name: str) -> tuple[int, int, int]:
    """Colour of a role that stands out 3:1 both from white and from the dark ground, for what has one colour in both.

    The colour on white, lightened or darkened to a relative luminance within 0.14 to 0.29 (WCAG 2.1, section 1.4.3).
    """
    red, green, blue = (_linear(level) for level in rgb(name, dark=False))
    light = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    factor = min(max(light, 0.14), 0.29) / light
    made = [min(1.0, factor * part) for part in (red, green, blue)]
    levels = [12.92 * part if part <= 0.0031308 else 1.055 * part ** (1 / 2.4) - 0.055 for part in made]
    return round(255 * levels[0]), round(255 * levels[1]), round(255 * levels[2])


def in_plots(name: str) -> tuple[int, int, int]:
    """Colour of a role's samples in the plots of Foxglove-compatible viewers.

    They draw a dot at each sample, its lightness less by 0.3 on a light ground, and a curve of many samples is a row of
    dots. So a role has a paler tone here: what is left of it on a light ground keeps its hue, where the colours of
    figures would be near black.
    """
    red, green, blue = rgb(name, dark=False)
    hue, lightness, saturation = colorsys.rgb_to_hls(red / 255, green / 255, blue / 255)
    pale = 0.7 if name.endswith("estimate") else 0.57
    made = colorsys.hls_to_rgb(hue, max(lightness, pale), min(saturation, 0.7))
    return round(255 * made[0]), round(255 * made[1]), round(255 * made[2])


def rgb(name: str, *, dark: bool = True) -> tuple[int, int, int]:
    """Colour of a role as three bytes, on the dark ground of the viewers unless `dark` is false."""
    text = role(name).on_dark if dark else role(name).on_light
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)
