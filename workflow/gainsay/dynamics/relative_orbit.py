"""Relative motion of two spacecraft in the target's rotating LVLH frame.

Frame: x along the radius from the Earth's centre to the target, z along the orbit's angular momentum, y completing the
right-handed triad (about along the velocity). The target moves on an unperturbed Kepler orbit.

References
----------
.. [1] W. H. Clohessy, R. S. Wiltshire, "Terminal guidance system for satellite rendezvous", J. Aerospace Sciences
   27(9), 653-658, 1960.
.. [2] R. H. Battin, "An Introduction to the Mathematics and Methods of Astrodynamics", AIAA, 1999, section 8.7 (the
   differential gravity of close orbits without cancellation).
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.exact.floats import real_array, real_number


def _require_positive(**values: float) -> None:
    for name, value in values.items():
        if not real_number(value, name) > 0:
            raise InputError("", field=name, value=value, expected="a positive finite number")


def mean_motion(gravitational_parameter: float, semi_major_axis: float) -> float:
    """Return the mean motion sqrt(mu / a^3), rad/s; raises InputError unless it and both numbers are positive."""
    _require_positive(gravitational_parameter=gravitational_parameter, semi_major_axis=semi_major_axis)
    try:
        rate = math.sqrt(gravitational_parameter / semi_major_axis**3)
    except (OverflowError, ZeroDivisionError):
        rate = 0.0
    if not 0 < rate < math.inf:
        numbers = (gravitational_parameter, semi_major_axis)
        raise InputError("", field="mu, a", value=numbers, expected="a mean motion within the range of doubles")
    return rate


def clohessy_wiltshire(rate: float) -> np.ndarray:
    """Return the 6x6 state matrix of linearised relative motion about a circular orbit [1]_.

    Parameters
    ----------
    rate : float
        Mean motion of the target, rad/s. States are position (m) and velocity (m/s) in LVLH.

    Raises
    ------
    InputError
        If the rate is not finite.
    """
    real_number(rate, "rate")
    A = np.zeros((6, 6))
    A[:3, 3:] = np.eye(3)
    A[3, 0], A[3, 4] = 3 * rate**2, 2 * rate
    A[4, 3] = -2 * rate
    A[5, 2] = -(rate**2)
    return A


def thrust_input(mass: float) -> np.ndarray:
    """Return the 6x3 input matrix of a force (N) along the LVLH axes on a mass (kg), which must be positive."""
    _require_positive(mass=mass)
    return np.vstack([np.zeros((3, 3)), np.eye(3) / mass])


@dataclass(frozen=True)
class KeplerOrbit:
    """An elliptic orbit, described by its true anomaly.

    Attributes
    ----------
    gravitational_parameter : float
        m^3/s^2.
    semi_major_axis : float
        m.
    eccentricity : float
        At least 0, below 1.

    Raises
    ------
    InputError
        If the first two are not positive, a motion with them leaves double precision, or the eccentricity is not that
        of an ellipse.
    """

    gravitational_parameter: float
    semi_major_axis: float
    eccentricity: float

    def __post_init__(self) -> None:
        _require_positive(gravitational_parameter=self.gravitational_parameter, semi_major_axis=self.semi_major_axis)
        if not 0 <= real_number(self.eccentricity, "eccentricity") < 1:
            raise InputError("", field="eccentricity", value=self.eccentricity, expected="at least 0, below 1")
        whole = (self.mean_motion, self.angular_momentum, self.angular_momentum / self.semi_latus_rectum)
        if not all(0 < number < math.inf for number in whole):
            raise InputError("", field="orbit", value=whole, expected="a motion within the range of doubles")

    @cached_property
    def mean_motion(self) -> float:
        """Mean motion, rad/s."""
        return mean_motion(self.gravitational_parameter, self.semi_major_axis)

    @cached_property
    def semi_latus_rectum(self) -> float:
        """Semi-latus rectum a (1 - e^2), m."""
        return self.semi_major_axis * (1 - self.eccentricity**2)

    @cached_property
    def angular_momentum(self) -> float:
        """Specific angular momentum, m^2/s."""
        return math.sqrt(self.gravitational_parameter * self.semi_latus_rectum)

    def radius(self, true_anomaly: Any) -> Any:
        """Distance from the Earth's centre, m, at a true anomaly or an array of them; InputError where it is none."""
        if isinstance(true_anomaly, np.ndarray):
            cosine = np.cos(real_array(true_anomaly, "true_anomaly"))
        else:
            cosine = math.cos(real_number(true_anomaly, "true_anomaly"))
        return self.semi_latus_rectum / (1 + self.eccentricity * cosine)

    def frame_motion(self, true_anomaly: Any) -> tuple[Any, Any, Any]:
        """Return radius (m), angular rate (rad/s) and angular acceleration (rad/s^2) of the LVLH frame, as `radius`."""
        e, h, p = self.eccentricity, self.angular_momentum, self.semi_latus_rectum
        radius = self.radius(true_anomaly)
        rate = h / radius**2
        radial_speed = h / p * e * (np.sin if isinstance(true_anomaly, np.ndarray) else math.sin)(true_anomaly)
        return radius, rate, -2 * radial_speed * rate / radius

    def inertial_state(self, true_anomaly: float) -> tuple[np.ndarray, np.ndarray]:
        """Return position (3,) m and velocity (3,) m/s in the perifocal inertial frame."""
        e, h, p = self.eccentricity, self.angular_momentum, self.semi_latus_rectum
        radius = self.radius(true_anomaly)
        direction = np.array([math.cos(true_anomaly), math.sin(true_anomaly), 0.0])
        velocity = h / p * np.array([-math.sin(true_anomaly), e + math.cos(true_anomaly), 0.0])
        return radius * direction, velocity


def _triple(values: Iterable[Any], field: str) -> tuple[Any, Any, Any]:
    """Three numbers, or three arrays of them; nan passes, as a trial step of an integrator may hold it."""
    try:
        x, y, z = values
    except (TypeError, ValueError) as error:
        raise InputError("", field=field, value=type(values).__name__, expected="three numbers or arrays") from error
    for part in (x, y, z):
        # the abstract class last: it is the slowest to ask, and this is asked at every step of an integrator
        if not isinstance(part, (float, np.ndarray, Real)):
            raise InputError("", field=field, value=(x, y, z), expected="three numbers or arrays")
    return x, y, z


def differential_gravity(
    gravitational_parameter: float, radius: float, x: float, y: float, z: float
) -> tuple[float, float, float]:
    """Return the gravity of the chaser minus that of the target, m/s^2, without cancellation [2]_.

    Parameters
    ----------
    gravitational_parameter : float
        m^3/s^2.
    radius : float
        Distance of the target from the Earth's centre, m.
    x, y, z : float or ndarray
        Position of the chaser in LVLH, m; arrays of one shape for many chasers.

    Raises
    ------
    InputError
        If the first two are not positive, the position is none, or the chaser stands in the Earth's centre.

    Notes
    -----
    With q = d . (d + 2 r) / r^2 and f = (1 + q)^(3/2) - 1 = q (3 + 3 q + q^2) / (1 + (1 + q)^(3/2)) the difference is
    -mu / (r^3 (1 + f)) (d - f r).
    """
    _require_positive(gravitational_parameter=gravitational_parameter, radius=radius)
    return _differential_gravity(gravitational_parameter, radius, *_triple((x, y, z), "position"))


def _differential_gravity(mu: float, radius: float, x: Any, y: Any, z: Any) -> tuple[Any, Any, Any]:
    """The same of numbers that have been looked at."""
    q = (x * (x + 2 * radius) + y * y + z * z) / radius**2
    if not isinstance(q, np.ndarray) and 1 + q <= 0:
        raise InputError("", field="position", value=(x, y, z), expected="a place away from the Earth's centre")
    cube = (1 + q) * (np.sqrt(1 + q) if isinstance(q, np.ndarray) else math.sqrt(1 + q))
    f = q * (3 + 3 * q + q * q) / (1 + cube)
    factor = -mu / (radius**3 * cube)
    # mu/r^2 - mu r/rc^3 = mu/r^2 (1 - 1/cube) = mu/r^2 f/cube
    return factor * (x - f * radius), factor * y, factor * z


def relative_acceleration(
    orbit: KeplerOrbit, true_anomaly: Any, position: Iterable[Any], velocity: Iterable[Any]
) -> tuple[Any, Any, Any]:
    """Return the free relative acceleration in the rotating LVLH frame, m/s^2.

    Parameters
    ----------
    orbit : KeplerOrbit
        Orbit of the target.
    true_anomaly : float or ndarray
        Of the target, rad; an array goes together with those of the position.
    position, velocity : 3 floats or 3 arrays of one shape
        Of the chaser, or of many, relative to the target, in the rotating frame, m and m/s.

    Raises
    ------
    InputError
        If the anomaly, the position or the velocity is none.
    """
    x, y, z = _triple(position, "position")
    vx, vy, _ = _triple(velocity, "velocity")
    radius, rate, spin = orbit.frame_motion(true_anomaly)
    gx, gy, gz = _differential_gravity(orbit.gravitational_parameter, radius, x, y, z)
    return (
        gx + rate * rate * x + 2 * rate * vy + spin * y,
        gy + rate * rate * y - 2 * rate * vx - spin * x,
        gz,
    )
