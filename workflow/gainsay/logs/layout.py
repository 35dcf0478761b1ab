"""What a viewer shows of a run, declared once; the Rerun blueprint and the Foxglove layout are made from it.

A `Layout` is a row of tabs. A tab holds one panel, or panels in `Rows` and `Columns`. Colours come from roles
(`gainsay.logs.palette`), units from the titles, which end in ``[unit]``.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TypeAlias

from gainsay.errors import InputError
from gainsay.logs.palette import role as known_role
from gainsay.logs.schemas import check_name, check_topic
from gainsay.logs.writer import EVENTS

_UNIT = re.compile(r".*\S \[([^\[\]]+)\]")


@dataclass(frozen=True)
class Line:
    """One curve of a plot: a field of a topic, its label in the legend and its colour role."""

    topic: str
    field: str
    label: str
    role: str

    def __post_init__(self) -> None:
        check_topic(self.topic)
        check_name(self.field, f"field of {self.topic}")
        known_role(self.role)
        if not self.label:
            raise InputError(f"label of {self.topic}.{self.field}", value=self.label, expected="some text")


def lines(topic: str, fields: Sequence[str], *, labels: Sequence[str] = (), suffix: str = "") -> tuple[Line, ...]:
    """Fields of a topic as curves, the first in the colour of axis 1, the second of axis 2, and so on.

    Parameters
    ----------
    topic : str
    fields : sequence of str
    labels : sequence of str, optional
        What the legend says; the names of the fields unless given.
    suffix : str, optional
        Of the roles, such as ``_estimate`` for the estimates of the three axes.

    Examples
    --------
    >>> from gainsay.logs import lines
    >>> [(line.label, line.role) for line in lines("/observer/state", "xy", suffix="_estimate")]
    [('x', 'axis_1_estimate'), ('y', 'axis_2_estimate')]
    """
    return tuple(
        Line(topic, name, label, f"axis_{axis}{suffix}")
        for axis, (name, label) in enumerate(zip(fields, labels or fields, strict=True), start=1)
    )


@dataclass(frozen=True)
class Bound:
    """A bound of a plot.

    Attributes
    ----------
    name : str
        A bound that the run logs with `LogWriter.bound`.
    label : str
        What the legend says.
    role : str
        Colour: that of the curve that it bounds.
    sides : tuple of str
        ``lower``, ``upper``; by default those that the run logs. A norm has no lower bound.
    """

    name: str
    label: str = ""
    role: str = "bound"
    sides: tuple[str, ...] = ("lower", "upper")

    def __post_init__(self) -> None:
        known_role(self.role)
        if not self.sides or not set(self.sides) <= {"lower", "upper"}:
            raise InputError(f"sides of bound {self.name}", value=self.sides, expected="lower, upper or both")


@dataclass(frozen=True)
class Plot:
    """Curves over time.

    Attributes
    ----------
    title : str
        Ends in the unit that all its curves have, e.g. ``Thrust [N]``.
    lines : tuple of Line
    bounds : tuple of Bound
    until : float, optional
        End of the time shown at first, s, where all that matters is over long before the run ends.
    """

    title: str
    lines: tuple[Line, ...]
    bounds: tuple[Bound, ...] = ()
    until: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "lines", tuple(self.lines))
        object.__setattr__(self, "bounds", tuple(self.bounds))
        if not self.lines:
            raise InputError(f"plot {self.title!r}", expected="one line at least")
        if not _UNIT.fullmatch(self.title):
            raise InputError("title of a plot", value=self.title, expected="a unit in brackets at its end")
        if self.until is not None and not self.until > 0:
            raise InputError(f"plot {self.title!r}", field="until", value=self.until, expected="a time after 0")

    @property
    def unit(self) -> str:
        """Unit named by the title."""
        match = _UNIT.fullmatch(self.title)
        assert match, "checked when made"
        return match[1]


@dataclass(frozen=True)
class Scene:
    """A three-dimensional view.

    Attributes
    ----------
    title : str
    frame : str
        Frame in which everything is shown.
    elements : tuple of str
        Names of the scene elements of the log (`LogWriter.line`, `.arrows`, `.body`, `.marker`).
    axes : tuple of str
        Frames whose axes are shown; the log draws them with `LogWriter.axes`.
    follow : str
        Frame that the camera follows, where one moves far; by default none.
    direction : tuple of 3 floats
        Direction in `frame` from what is drawn to the camera, which stands so far off that all is seen; by default
        obliquely from above, a little off the diagonal, so that no two axes fall onto each other.
    """

    title: str
    frame: str
    elements: tuple[str, ...] = ()
    axes: tuple[str, ...] = ()
    follow: str = ""
    direction: tuple[float, float, float] = (0.64, -0.62, 0.46)

    def __post_init__(self) -> None:
        object.__setattr__(self, "elements", tuple(self.elements))
        object.__setattr__(self, "axes", tuple(self.axes))
        if self.follow and self.follow not in self.axes:
            raise InputError(f"scene {self.title!r} follows", value=self.follow, expected="a frame of its axes")

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics of everything drawn."""
        return tuple(f"/scene/{name}" for name in (*self.elements, *(f"axes_{frame}" for frame in self.axes)))


@dataclass(frozen=True)
class Text:
    """A page of Markdown: what is seen, and which claim it bears on."""

    title: str
    markdown: str


@dataclass(frozen=True)
class EventLog:
    """The events of the run."""

    title: str = "Events"


@dataclass(frozen=True)
class Rows:
    """Items below each other; `shares` are their relative heights."""

    items: tuple["Item", ...]
    shares: tuple[float, ...] = ()

    def __init__(self, *items: "Item", shares: tuple[float, ...] = ()) -> None:
        _split(self, items, shares)


@dataclass(frozen=True)
class Columns:
    """Items beside each other; `shares` are their relative widths."""

    items: tuple["Item", ...]
    shares: tuple[float, ...] = ()

    def __init__(self, *items: "Item", shares: tuple[float, ...] = ()) -> None:
        _split(self, items, shares)


def _split(into: Rows | Columns, items: tuple["Item", ...], shares: tuple[float, ...]) -> None:
    if not items or (shares and len(shares) != len(items)) or any(share <= 0.0 for share in shares):
        raise InputError("shares of a split", value=shares, expected=f"a positive one for each of {len(items)} items")
    object.__setattr__(into, "items", tuple(items))
    object.__setattr__(into, "shares", tuple(shares) or (1.0,) * len(items))


Panel: TypeAlias = Plot | Scene | Text | EventLog
Item: TypeAlias = Panel | Rows | Columns


@dataclass(frozen=True)
class Tab:
    """One page of a layout.

    Attributes
    ----------
    title : str
    content : Item
    runs : tuple of str
        Runs it is shown for; by default all.
    """

    title: str
    content: Item
    runs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Layout:
    """Everything a viewer shows.

    Attributes
    ----------
    name : str
        Name of the paper, ``[a-z0-9_]+``; part of the application id in Rerun.
    tabs : tuple of Tab
        The first one is open.
    look : mapping of str to str
        What to look at in a run, a sentence or two; under the empty name for every run that has none of its own.
    """

    name: str
    tabs: tuple[Tab, ...]
    look: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "tabs", tuple(self.tabs))
        if not self.tabs or len({tab.title for tab in self.tabs}) != len(self.tabs):
            raise InputError(f"tabs of {self.name}", expected="one at least, each title once")
        if not re.fullmatch("[a-z0-9_]+", self.name):
            raise InputError("name of a layout", value=self.name, expected="lower-case letters, digits, underscores")

    def for_run(self, run: str, about: Mapping[str, str] = MappingProxyType({})) -> "Layout":
        """Return the layout with the tabs that `run` has, its name, what it is and what to look at above the first.

        Parameters
        ----------
        run : str
        about : mapping of str to str
            Metadata of its log: ``about`` says what the run is, ``title`` what the paper.
        """
        tabs = [tab for tab in self.tabs if not tab.runs or run in tab.runs]
        if tabs and about.get("about"):
            look = self.look.get(run, self.look.get("", ""))
            text = f"**{self.name}, run {run}**: {about['about']}. *{about.get('title', '')}*\n\n{look}\n"
            tabs[0] = replace(tabs[0], content=Rows(Text("Run", text), tabs[0].content, shares=(1, 9)))
        return replace(self, tabs=tuple(tabs))

    def panels(self) -> Iterator[Panel]:
        """Every panel, in the order of the tabs."""
        for tab in self.tabs:
            yield from _panels(tab.content)


def _panels(item: Item) -> Iterator[Panel]:
    if isinstance(item, Rows | Columns):
        for inner in item.items:
            yield from _panels(inner)
    else:
        yield item


def tab(
    title: str, *plots: Plot, scene: Scene | None = None, shares: tuple[float, ...] = (), runs: tuple[str, ...] = ()
) -> Tab:
    """Plots below each other, beside a scene where there is one.

    Parameters
    ----------
    title : str
    *plots : Plot
    scene : Scene, optional
    shares : tuple of float, optional
        Relative heights of the plots.
    runs : tuple of str, optional
        Runs that the tab is shown for; by default all.
    """
    stack = Rows(*plots, shares=shares)
    return Tab(title, stack if scene is None else Columns(scene, stack), runs)


def default_layout(name: str, about: str, *parts: Tab | Plot, look: Mapping[str, str] = MappingProxyType({})) -> Layout:
    """Layout of a paper's runs: the tabs, then one that says what all runs show, beside the events of this one.

    Parameters
    ----------
    name : str
        Of the paper.
    about : str
        Markdown.
    *parts : Tab or Plot
        Tabs; or plots alone, which stand below each other in one.
    look : mapping of str to str, optional
        What to look at in a run, as in `Layout`.
    """
    tabs = [part for part in parts if isinstance(part, Tab)]
    plots = [part for part in parts if isinstance(part, Plot)]
    response = [tab("Response", *plots)] if plots else []
    return Layout(name, (*response, *tabs, Tab("About", Columns(Text("About", about), EventLog()))), dict(look))


def bound_lines(plot: Plot, fields: dict[str, tuple[str, ...]]) -> list[Line]:
    """Lines of the bounds of a plot.

    Parameters
    ----------
    plot : Plot
    fields : dict
        Fields (``lower``, ``upper``) that the log has for each bound.
    """
    lines = []
    for bound in plot.bounds:
        logged = fields.get(bound.name, bound.sides)
        sides = [side for side in bound.sides if side in logged]
        for side in sides:
            label = bound.label or bound.name
            lines.append(
                Line(f"/bounds/{bound.name}", side, f"{label} ({side})" if len(sides) > 1 else label, bound.role)
            )
    return lines


def playback_speed(duration: float) -> float:
    """Speed at which a run takes about half a minute: 1, 2 or 5 times a power of ten."""
    speed, steps = 1.0, (2.0, 2.5, 2.0)
    for step in range(30):
        if duration / speed <= 30.0:
            break
        speed *= steps[step % 3]
    return speed


EVENT_TOPIC = EVENTS
