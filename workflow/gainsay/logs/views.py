"""Files for viewers beside each log: one self-contained ``.rrd`` and a layout for Foxglove-compatible viewers.

Both are made from the log and the one `Layout`, and are never hashed or compared: an ``.rrd`` differs from run to run.
"""

import re
from collections.abc import Mapping
from pathlib import Path

from gainsay.errors import InputError
from gainsay.logs.check import check_layout
from gainsay.logs.eye import Eye, eyes_of
from gainsay.logs.foxglove import foxglove_layout
from gainsay.logs.layout import Layout, Scene
from gainsay.logs.quiet import quiet
from gainsay.logs.reader import Log, read_log
from gainsay.logs.shapes import Shapes
from gainsay.tables.files import write_atomically

FOXGLOVE_SUFFIX = ".foxglove.json"


def write_views(mcap: Path, layout: Layout, log: Log | None = None) -> list[Path]:
    """Write ``<run>.rrd`` and ``<run>.foxglove.json`` beside ``<run>.mcap``.

    Parameters
    ----------
    mcap : Path
        The log.
    layout : Layout
        What is shown; it is checked against the log first.
    log : Log, optional
        The log as read, where it was read already.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    LogError
        The log is damaged, or the layout does not fit it.
    """
    mcap = Path(mcap)
    log = read_log(mcap) if log is None else log
    fitted = layout.for_run(mcap.stem, log.metadata)
    check_layout(fitted, log)
    rrd, foxglove = mcap.with_suffix(".rrd"), mcap.with_suffix(FOXGLOVE_SUFFIX)
    shapes = Shapes(log)
    eyes = eyes_of(fitted, shapes)
    write_atomically(foxglove, foxglove_layout(fitted, log, eyes))
    write_atomically(rrd, _recording(mcap, fitted, shapes, eyes))
    return [rrd, foxglove]


def _recording(mcap: Path, layout: Layout, shapes: Shapes, eyes: Mapping[Scene, Eye]) -> bytes:
    """Return the content of the ``.rrd``: the signals of the log, its drawings and text pages, and the blueprint.

    It is made in memory: a stream to a file does not say that its end was lost to a full disk.
    """
    application, recording = f"gainsay_{layout.name}", mcap.stem
    if not re.fullmatch("[a-z0-9_]+", recording):
        # Other letters make the viewer lose the tie between recording and blueprint.
        raise InputError("name of a run", value=recording, expected="lower-case letters, digits and underscores")
    with quiet():
        import rerun as rr
        from rerun.chunk import McapReader

        from gainsay.logs.blueprint import blueprint
        from gainsay.logs.drawing import draw

        stream = rr.RecordingStream(application, recording_id=recording, send_properties=False)
        whole = stream.memory_recording()
        stream.set_log_time_enabled(False)
        signals = McapReader(mcap, timeline_type="duration_ns", exclude_topic_regex=["^/scene/"])
        stream.send_chunks(signals.stream())
        draw(layout, shapes, stream)
        stream.send_blueprint(blueprint(layout, shapes.log, eyes))
        content = whole.drain_as_bytes()
        stream.disconnect()
    return content
