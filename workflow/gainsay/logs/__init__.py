"""Logs of single runs: written once, read back bit for bit, shown by common viewers."""

from gainsay.logs.layout import (
    Bound,
    Columns,
    EventLog,
    Layout,
    Line,
    Plot,
    Rows,
    Scene,
    Tab,
    Text,
    default_layout,
    lines,
    tab,
)
from gainsay.logs.linear import linear_run
from gainsay.logs.reader import Event, Extreme, Log, Signal, read_log
from gainsay.logs.runs import Measure, Measured, RunSpec, Simulate, located, measuring
from gainsay.logs.scene import Appendage, Body
from gainsay.logs.writer import LogWriter

__all__ = [
    "Appendage",
    "Body",
    "Bound",
    "Columns",
    "Event",
    "EventLog",
    "Extreme",
    "Layout",
    "Line",
    "Log",
    "LogWriter",
    "Measure",
    "Measured",
    "Plot",
    "Rows",
    "RunSpec",
    "Scene",
    "Signal",
    "Simulate",
    "Tab",
    "Text",
    "default_layout",
    "linear_run",
    "lines",
    "located",
    "measuring",
    "read_log",
    "tab",
]
