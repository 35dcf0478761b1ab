"""Offline check of a layout against a log: viewers show nothing, and say nothing, where a path is wrong."""

from gainsay.errors import LogError
from gainsay.logs.layout import EVENT_TOPIC, EventLog, Layout, Plot, Scene, bound_lines
from gainsay.logs.reader import Log


def layout_problems(layout: Layout, log: Log) -> list[str]:
    """List what in `layout` does not resolve in `log`, a sentence each; empty where all is well."""
    problems: list[str] = []
    frames = set(log.frames) | set(log.frames.values())
    for panel in layout.panels():
        if isinstance(panel, Plot):
            problems += _plot(panel, log)
        elif isinstance(panel, Scene):
            problems += _scene(panel, log, frames)
        elif isinstance(panel, EventLog) and not log.events:
            problems.append(f"event log {panel.title!r}: no event on {EVENT_TOPIC}")
        if not panel.title.strip():
            problems.append("a panel without a title")
    return problems


def check_layout(layout: Layout, log: Log) -> None:
    """Check that every path, unit, frame and element of `layout` exists in `log`.

    Raises
    ------
    LogError
        Names the first thing that does not resolve and how many more there are.
    """
    problems = layout_problems(layout, log)
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise LogError(f"layout {layout.name}: {problems[0]}{more}", file=log.path.name)


def _plot(plot: Plot, log: Log) -> list[str]:
    problems = []
    for bound in plot.bounds:
        if bound.name not in log.bounds:
            problems.append(f"plot {plot.title!r}: no bound {bound.name!r} in the log")
    known = {name: tuple(sides) for name, sides in log.bounds.items()}
    for line in (*plot.lines, *bound_lines(plot, {bound.name: known.get(bound.name, ()) for bound in plot.bounds})):
        if line.topic not in log:
            problems.append(f"plot {plot.title!r}: no signal {line.topic}")
        elif line.field not in log[line.topic].fields:
            problems.append(f"plot {plot.title!r}: no field {line.field!r} in {line.topic}")
        elif not len(log[line.topic].time):
            problems.append(f"plot {plot.title!r}: no message on {line.topic}")
        elif log[line.topic].units[line.field] != plot.unit:
            unit = log[line.topic].units[line.field]
            problems.append(f"plot {plot.title!r}: {line.topic}.{line.field} is in {unit!r}")
    return problems


def _scene(scene: Scene, log: Log, frames: set[str]) -> list[str]:
    problems = [
        f"scene {scene.title!r}: no frame {frame!r}"
        for frame in (scene.frame, *scene.axes, *([scene.follow] if scene.follow else []))
        if frame not in frames
    ]
    root = _root(scene.frame, log)
    for topic in scene.topics:
        element = topic.removeprefix("/scene/")
        if topic not in log.topics or not log.count(topic):
            problems.append(f"scene {scene.title!r}: no element {element!r}")
            continue
        for frame in {entity.frame_id for _, message in log.messages(topic) for entity in message.entities}:
            if frame not in frames or _root(frame, log) != root:
                problems.append(f"scene {scene.title!r}: frame {frame!r} of {element!r} is not tied to {scene.frame!r}")
    if not scene.topics:
        problems.append(f"scene {scene.title!r}: nothing to draw")
    return problems


def _root(frame: str, log: Log) -> str:
    """Frame at the top of the tree of `frame`."""
    seen = set()
    while frame in log.frames and frame not in seen:
        seen.add(frame)
        frame = log.frames[frame]
    return frame
