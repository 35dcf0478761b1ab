"""Layout file for Foxglove-compatible viewers (Lichtblick, Foxglove), made from the same `Layout`.

Text pages are left out: the open viewers have no panel for text.
"""

import json
from collections.abc import Mapping
from math import acos, atan2, degrees, hypot

from gainsay.logs.eye import Eye, eyes_of
from gainsay.logs.layout import (
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
from gainsay.logs.palette import in_plots, on_both, role
from gainsay.logs.reader import Log
from gainsay.logs.shapes import Shapes

#: how much farther away the camera stands than in Rerun: its field of view is that of the height, and panels are narrow
_NARROW = 1.35


def foxglove_layout(layout: Layout, log: Log, eyes: Mapping[Scene, Eye] | None = None) -> str:
    """JSON text of the layout, importable in Lichtblick and Foxglove.

    Parameters
    ----------
    layout : Layout
    log : Log
        A log the layout is for; tells which sides each bound has.
    eyes : mapping of Scene to Eye, optional
        The cameras, where they are known from `eyes_of`.
    """
    eyes = eyes_of(layout, Shapes(log)) if eyes is None else eyes
    return json.dumps(_Builder(log, eyes).build(layout), indent=1, sort_keys=True) + "\n"


class _Builder:
    def __init__(self, log: Log, eyes: Mapping[Scene, Eye]) -> None:
        self.sides = {name: tuple(sides) for name, sides in log.bounds.items()}
        self.log, self.duration, self.eyes = log, log.duration, eyes
        self.panels: dict[str, dict] = {}

    def build(self, layout: Layout) -> dict:
        trees = [(tab.title, self.tree(tab.content)) for tab in layout.tabs]
        tabs = [{"title": title, "layout": tree} for title, tree in trees if tree is not None]
        # Of a tab's title a viewer shows a dozen letters: paper and run stand above the first panel.
        first = next(iter(self.panels.values()))
        for key in {"title", "foxglovePanelTitle"} & first.keys():
            first[key] = f"{layout.name} {self.log.path.stem}: {first[key]}"
        top = self.add("Tab", {"activeTabIdx": 0, "tabs": tabs})
        return {
            "configById": self.panels,
            "globalVariables": {},
            "userNodes": {},
            "playbackConfig": {"speed": playback_speed(self.duration)},
            "layout": top,
        }

    def add(self, kind: str, config: dict) -> str:
        number = sum(name.startswith(kind + "!") for name in self.panels) + 1
        name = f"{kind}!{kind.lower()}{number}"
        self.panels[name] = config
        return name

    def tree(self, item: Item) -> str | dict | None:
        """Panel id, or nested splits of two (the format has no splits of more); None where only text would be."""
        if isinstance(item, Text):
            return None
        if not isinstance(item, Rows | Columns):
            return self.panel(item)
        parts = [(self.tree(part), share) for part, share in zip(item.items, item.shares, strict=True)]
        shown = [(tree, share) for tree, share in parts if tree is not None]
        return self.split("column" if isinstance(item, Rows) else "row", shown)

    def split(self, direction: str, parts: list[tuple[str | dict, float]]) -> str | dict | None:
        if len(parts) < 2:
            return parts[0][0] if parts else None
        return {
            "direction": direction,
            "first": parts[0][0],
            "second": self.split(direction, parts[1:]),
            "splitPercentage": round(100.0 * parts[0][1] / sum(share for _, share in parts), 3),
        }

    def panel(self, panel: Plot | Scene | EventLog) -> str:
        match panel:
            case Plot():
                return self.add("Plot", self.plot(panel))
            case Scene():
                return self.add("3D", self.scene(panel))
            case EventLog():
                return self.add(
                    "RosOut", {"foxglovePanelTitle": panel.title, "topicToRender": "/events", "searchTerms": []}
                )

    def plot(self, plot: Plot) -> dict:
        return {
            "foxglovePanelTitle": plot.title,
            "title": plot.title,
            "paths": [self.path(line) for line in (*plot.lines, *bound_lines(plot, self.sides))],
            "xAxisVal": "timestamp",
            "showLegend": True,
            "legendDisplay": "left",
            "sidebarDimension": 170,
            "isSynced": True,
            "showXAxisLabels": True,
            "showYAxisLabels": True,
            "yAxisLabel": plot.unit,
            **({} if plot.until is None else {"minXValue": 0, "maxXValue": plot.until}),
        }

    @staticmethod
    def path(line: Line) -> dict:
        # A bound is two samples, a line without dots; the ground is the user's choice.
        tone = on_both if line.topic.startswith("/bounds/") else in_plots
        return {
            "value": f"{line.topic}.{line.field}",
            "enabled": True,
            "timestampMethod": "receiveTime",
            "label": line.label,
            "color": "#{:02x}{:02x}{:02x}".format(*tone(line.role)),
            "lineSize": 1.2 * role(line.role).width,
            "showLine": True,
        }

    def scene(self, scene: Scene) -> dict:
        return {
            "foxglovePanelTitle": scene.title,
            "followTf": scene.follow or scene.frame,
            "followMode": "follow-pose" if not scene.follow else "follow-position",
            "scene": {
                "transforms": {"enablePreloading": True, "axisScale": 0, "lineWidth": 0, "showLabel": False},
                "labelScaleFactor": 1,
            },
            "transforms": {},
            "topics": {topic: {"visible": True} for topic in scene.topics},
            "layers": {},
            "cameraState": _camera(self.eyes[scene]),
        }


def _camera(eye: Eye) -> dict:
    """Camera state for an eye, z up."""
    x, y, z = (place - target for place, target in zip(eye.place, eye.target, strict=True))
    distance = hypot(x, y, z) * _NARROW
    return {
        "perspective": True,
        "distance": distance,
        "phi": degrees(acos(_NARROW * z / distance)),
        "thetaOffset": degrees(atan2(-x, -y)),
        "targetOffset": list(eye.target),
        "target": [0, 0, 0],
        "targetOrientation": [0, 0, 0, 1],
        "fovy": 45,
        "near": distance / 1000.0,
        "far": distance * 100.0,
    }
