"""Rerun blueprint made from a `Layout`. Imports rerun: see `gainsay.logs.drawing`."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

from gainsay.logs.drawing import TIMELINE, text_path
from gainsay.logs.eye import Eye
from gainsay.logs.layout import (
    EVENT_TOPIC,
    Columns,
    EventLog,
    Item,
    Layout,
    Line,
    Plot,
    Rows,
    Scene,
    Text,
    bound_lines,
    playback_speed,
)
from gainsay.logs.palette import rgb, role
from gainsay.logs.reader import Log
from gainsay.logs.schemas import signal_schema

_GROUND = [20, 22, 26]


def blueprint(layout: Layout, log: Log, eyes: Mapping[Scene, Eye]) -> rrb.Blueprint:
    """Blueprint of a layout for one log: tabs as declared, the first open, time from 0, nothing else open."""
    tabs = [_item(tab.content, log, eyes, tab.title) for tab in layout.tabs]
    return rrb.Blueprint(
        rrb.Tabs(*tabs, active_tab=0) if len(tabs) > 1 else tabs[0],
        rrb.TimePanel(
            state="collapsed", timeline=TIMELINE, playback_speed=playback_speed(log.duration), play_state="paused"
        ),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_layout=False,
        auto_views=False,
    )


def _item(item: Item, log: Log, eyes: Mapping[Scene, Eye], title: str = "") -> rrb.View | rrb.Container:
    view: rrb.View
    match item:
        case Rows():
            parts = [_item(part, log, eyes) for part in item.items]
            return rrb.Vertical(*parts, row_shares=list(item.shares), name=title or None)
        case Columns():
            parts = [_item(part, log, eyes) for part in item.items]
            return rrb.Horizontal(*parts, column_shares=list(item.shares), name=title or None)
        case Plot():
            view = _plot(item, log)
        case Scene():
            view = _scene(item, eyes[item])
        case Text():
            view = rrb.TextDocumentView(origin=text_path(item.title), name=item.title)
        case EventLog():
            view = rrb.TextLogView(
                origin=EVENT_TOPIC,
                name=item.title,
                columns=rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["loglevel", "body"]),
            )
    # A tab that holds one panel keeps its own title.
    return rrb.Vertical(view, name=title) if title and title != item.title else view


def _series(line: Line, log: Log) -> rrb.Visualizer:
    """One curve: a field of the message struct of a topic."""
    name, _ = signal_schema(line.topic, log[line.topic].fields)
    # Where a pixel stands for several samples the viewer would draw their mean, and a peak far below its height.
    look = rr.SeriesLines(
        names=line.label,
        colors=[*rgb(line.role), 255],
        widths=2.2 * role(line.role).width,
        aggregation_policy=rr.components.AggregationPolicy.MinMax,
    )
    mapping = VisualizerComponentMapping(
        target="Scalars:scalars",
        source_kind=ComponentSourceKind.SourceComponent,
        source_component=f"{name}:message",
        selector=f".{line.field}",
    )
    return look.visualizer(mappings=[mapping])


def _plot(plot: Plot, log: Log) -> rrb.TimeSeriesView:
    lines: defaultdict[Any, list[Any]] = defaultdict(list)
    sides = {name: tuple(bound) for name, bound in log.bounds.items()}
    for line in (*plot.lines, *bound_lines(plot, sides)):
        lines[line.topic].append(_series(line, log))
    return rrb.TimeSeriesView(
        name=plot.title,
        origin="/",
        contents=[f"+ {topic}" for topic in lines],
        overrides=dict(lines),
        plot_legend=rrb.PlotLegend(visible=True, corner=rrb.Corner2D.RightTop),
        axis_x=rrb.TimeAxis(
            view_range=rr.TimeRange(
                start=rrb.TimeRangeBoundary.absolute(seconds=0.0),
                end=rrb.TimeRangeBoundary.absolute(seconds=1.02 * (plot.until or log.duration)),
            )
        ),
        background=rrb.archetypes.PlotBackground(color=[*_GROUND, 255], show_grid=True),
    )


def _scene(scene: Scene, eye: Eye) -> rrb.Spatial3DView:
    look: dict[str, Any] = {"position": eye.place, "look_target": eye.target, "eye_up": (0.0, 0.0, 1.0)}
    if scene.follow:
        look["tracking_entity"] = f"/scene/axes_{scene.follow}/origin"
    return rrb.Spatial3DView(
        name=scene.title,
        origin="/",
        contents=[f"+ {topic}/**" for topic in scene.topics],
        background=_GROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        spatial_information=rrb.SpatialInformation(target_frame=scene.frame, show_axes=False),
        eye_controls=rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, **look),
    )
