"""Logs of single runs: written once, read back bit for bit, shown by common viewers."""

from gainsay.logs.layout import Bound, Columns, EventLog, Layout, Line, Plot, Rows, Scene, Tab, Text
from gainsay.logs.reader import Event, Extreme, Log, Signal, read_log
from gainsay.logs.runs import Measured, RunSpec
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
    "Measured",
    "Plot",
    "Rows",
    "RunSpec",
    "Scene",
    "Signal",
    "Tab",
    "Text",
    "read_log",
]
