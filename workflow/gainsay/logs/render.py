"""Pictures of a run as the Rerun viewer shows it, without a screen, and a check that no view is broken or empty.

Needs a Vulkan driver; Mesa's software rasterizer will do (package mesa-vulkan-drivers on Debian and Ubuntu).
"""

import io
import time as clock
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from gainsay.errors import GainsayError, LogError
from gainsay.logs.headless import Viewer, headless_viewer

_WAIT = 20.0  # seconds for the viewer to load, or to stop changing


class NotCheckedError(GainsayError):
    """The viewer cannot run here: nothing was checked, which is not a pass; commands end with exit code 3."""


@dataclass
class Rendering:
    """What was seen of one run.

    Attributes
    ----------
    run : str
    pictures : list of Path
        One a tab.
    views : list of str
        Names of the views looked at.
    problems : list of str
        Errors that views report, and views that are empty.
    """

    run: str
    pictures: list[Path] = field(default_factory=list)
    views: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def render(rrd: Path, png: Path, *, time: float | None = None) -> Rendering:
    """Open a run in the real viewer and take a picture of every tab.

    Parameters
    ----------
    rrd : Path
        File made by `gainsay.logs.views.write_views`.
    png : Path
        Picture of the first tab; those of further tabs get ``_2``, ``_3``, ... before the suffix.
    time : float, optional
        Time of the cursor, s; by default a fortieth of the run: early, while most runs still move.

    Raises
    ------
    NotCheckedError
        The viewer does not start here, or stops answering.
    """
    rrd, png = Path(rrd), Path(png)
    if not rrd.is_file():
        raise NotCheckedError(f"not checked: no file {rrd.name}")
    rendering = Rendering(rrd.stem)
    try:
        with headless_viewer() as viewer:
            _look(viewer, rrd, png, time, rendering)
    except (RuntimeError, OSError, ImportError, LogError) as error:
        raise NotCheckedError(f"not checked: {rrd.name}: the viewer failed: {str(error).splitlines()[0]}") from error
    return rendering


def _look(viewer: Viewer, rrd: Path, png: Path, time: float | None, rendering: Rendering) -> None:
    recording = _load(viewer, rrd)
    line = next((line for line in recording.timelines if line.name == recording.current_timeline), None)
    if line is None or line.time_type != "duration" or line.start != 0:
        rendering.problems.append(f"{rendering.run}: the time panel does not start at 0 of the simulation")
    end = (line.end or 0) / 1e9 if line else 0.0
    viewer.ask(viewer.client.set_time, duration=end / 40.0 if time is None else time, play_state="paused")
    tabs = _tabs(viewer.ask(viewer.client.get_blueprint, "recording").blueprint)
    for number, (tab, views) in enumerate(tabs, start=1):
        if tab:
            blueprint = viewer.ask(viewer.client.get_blueprint, "recording").blueprint
            _top(blueprint)["active_tab"] = tab
            viewer.ask(viewer.client.set_blueprint, blueprint, "recording")
        picture = png if number == 1 else png.with_name(f"{png.stem}_{number}{png.suffix}")
        picture.write_bytes(_steady(viewer))
        rendering.pictures.append(picture)
        for view in viewer.ask(viewer.client.get_state).views:
            if f"view/{view.view_id}" not in views:
                continue
            rendering.views.append(view.name)
            rendering.problems += [f"{rendering.run}: {view.name}: {r.severity}: {r.summary}" for r in view.reports]
            if empty(viewer.ask(viewer.client.take_screenshot, view.view_id), view.view_class):
                rendering.problems.append(f"{rendering.run}: {view.name}: empty")
    rendering.problems = list(dict.fromkeys(rendering.problems))
    shown = sum(len(views) for _, views in tabs)
    if not shown or shown != len(rendering.views):
        rendering.problems.append(f"{rendering.run}: {len(rendering.views)} views seen of {shown} in the blueprint")


def _load(viewer: Viewer, rrd: Path) -> Any:
    viewer.ask(viewer.client.open, str(rrd.resolve()))
    limit = clock.monotonic() + _WAIT
    while clock.monotonic() < limit:
        state = viewer.ask(viewer.client.get_state)
        if not state.loading and state.recordings and state.recordings[0].timelines and state.views:
            return state.recordings[0]
        if not state.loading and not state.recordings and (error := viewer.complaint()):
            raise RuntimeError(error)
        clock.sleep(0.1)
    raise TimeoutError(f"it showed nothing of the file within {_WAIT:g} s")


def _steady(viewer: Viewer) -> bytes:
    """Screenshot of the whole viewer, once two in a row are the same."""
    before, limit = b"", clock.monotonic() + _WAIT
    while clock.monotonic() < limit:
        clock.sleep(0.3)
        picture = viewer.ask(viewer.client.take_screenshot)
        if picture == before:
            break
        before = picture
    return before


def _top(blueprint: dict[str, Any]) -> dict[str, Any]:
    root = blueprint["/viewport"]["ViewportBlueprint"]["root_container"]
    return blueprint[f"/container/{root}"]["ContainerBlueprint"]


def _contents(container: dict[str, Any]) -> list[str]:
    """Paths inside a container; the viewer writes a list of one as its one element."""
    contents = container["contents"]
    return [contents] if isinstance(contents, str) else contents


def _tabs(blueprint: dict[str, Any]) -> list[tuple[str, set[str]]]:
    """List each tab of a blueprint and the views inside it; without tabs, one entry without a name."""

    def views(path: str) -> set[str]:
        if path.startswith("view/"):
            return {path}
        return set().union(*(views(inner) for inner in _contents(blueprint["/" + path]["ContainerBlueprint"])))

    top = _top(blueprint)
    tabs = [(path, views(path)) for path in _contents(top)]
    if top["container_kind"] == "Tabs" and len(tabs) > 1:
        return tabs
    return [("", set().union(*(views for _, views in tabs)))]


def empty(png: bytes, view_class: str) -> bool:
    """Decide whether a view shows nothing besides its frame.

    Parameters
    ----------
    png : bytes
        Screenshot of the view alone.
    view_class : str
        As the viewer names it. What each shows without content does not count: axis labels, legend and time cursor of
        a plot, the head of a text log, the word ``(empty)`` in the corner of a text page.
    """
    from PIL import Image

    image = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)
    codes = image[..., 0] << 16 | image[..., 1] << 8 | image[..., 2]
    values, counts = np.unique(codes, return_counts=True)
    ground = int(values[counts.argmax()])
    background = np.array([ground >> 16, ground >> 8 & 255, ground & 255])
    stands_out = np.abs(image - background).max(axis=2) > 60
    if view_class == "TimeSeries":
        # A curve, be it of a run that ends early, takes more columns of the plot than its legend and labels.
        inner = stands_out[2:-17, 60:-10]
        return not inner.size or bool(inner.any(axis=0).mean() < 0.2)
    if view_class == "TextLog":
        return bool(stands_out[45:].sum() < 30)
    if view_class == "TextDocument":
        return not (stands_out[30:].any() or stands_out[:, 60:].any())
    return bool(stands_out.mean() < 5e-4)
