"""What a log draws in three dimensions: lines, markers, axes, arrows and bodies, each on ``/scene/<name>``."""

import numpy as np

from gainsay.errors import InputError
from gainsay.logs import scene


class Elements:
    """The drawing part of `gainsay.logs.writer.LogWriter`."""

    def _scene(self, name: str, time: float, entity: object) -> None:
        raise NotImplementedError

    def line(self, name: str, frame: str, points: object, role: str, *, time: float = 0.0, width: float = 2.0) -> None:
        """Draw a curve through `points` (N, 3), m, in `frame` from `time` on; `width` in pixels."""
        self._scene(name, time, scene.line(frame, points, role, width))

    def marker(self, name: str, frame: str, position: object, size: float, role: str, *, label: str = "") -> None:
        """Draw a ball of diameter `size`, m, at `position` (3,) of `frame`, with a label."""
        self._scene(name, 0.0, scene.marker(frame, position, size, role, label))

    def axes(
        self, frame: str, length: float, *, labels: tuple[str, str, str] = ("x", "y", "z"), name: str = ""
    ) -> None:
        """Draw the axes of `frame`, `length` m long, as element ``axes_<frame>``; a `name` is shown with the length."""
        self._scene(f"axes_{frame}", 0.0, scene.axes(frame, length, labels, name))

    def arrows(
        self,
        name: str,
        frame: str,
        time: object,
        vectors: object,
        scale: float,
        role: str,
        *,
        origin: object = (0, 0, 0),
    ) -> None:
        """Draw a vector over time, at most `scene.UPDATES` of the samples evenly chosen.

        Parameters
        ----------
        name, frame : str
            Name of the element; frame of its components.
        time : (N,) array_like
            Seconds.
        vectors : (N, 3) array_like
            Thrust, torque or the like.
        scale : float
            Metres drawn for one unit of the vector.
        role : str
            Colour role.
        origin : (3,) array_like
            Foot of the arrow in `frame`, m.
        """
        clock = np.asarray(time, dtype=float)
        arrows = np.asarray(vectors, dtype=float)
        if arrows.shape != (len(clock), 3):
            raise InputError(f"vectors of {name} have shape", value=arrows.shape, expected=f"({len(clock)}, 3)")
        for row in scene.chosen(len(clock)):
            self._scene(name, clock[row], scene.arrow(frame, origin, arrows[row] * scale, role))

    def body(self, name: str, frame: str, body: scene.Body, time: object = (0.0,), modal: object | None = None) -> None:
        """Draw a spacecraft body in its own `frame`, its appendages deflected by modal coordinates.

        Parameters
        ----------
        name, frame : str
            Name of the element; the body frame, which `transform` moves.
        body : Body
            Box and appendages.
        time : (N,) array_like
            Seconds.
        modal : (N, m) array_like, optional
            Modal coordinates over time; zero by default. At most `scene.UPDATES` of the samples are drawn.
        """
        clock = np.asarray(time, dtype=float)
        modes = max((len(appendage.tip) for appendage in body.appendages), default=0)
        shapes = np.zeros((len(clock), modes)) if modal is None else np.asarray(modal, dtype=float)
        if shapes.ndim != 2 or len(shapes) != len(clock) or shapes.shape[1] < modes:
            raise InputError(
                f"modal coordinates of {name} have shape", value=shapes.shape, expected=f"({len(clock)}, {modes})"
            )
        for row in scene.chosen(len(clock)):
            self._scene(name, clock[row], scene.body(frame, body, shapes[row]))
