"""Files for viewers beside each log: one self-contained ``.rrd`` and a layout for Foxglove-compatible viewers.

Both are made from the log and the one `Layout`, and are never hashed or compared: an ``.rrd`` differs from run to run.
"""

import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

from gainsay.errors import InputError
from gainsay.logs.check import check_layout
from gainsay.logs.eye import Eye, eyes_of
from gainsay.logs.foxglove import foxglove_layout
from gainsay.logs.layout import Layout, Scene
from gainsay.logs.quiet import call, quiet
from gainsay.logs.reader import Log, read_log

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
        The log is damaged, the layout does not fit it, or Rerun fails.
    """
    mcap = Path(mcap)
    log = read_log(mcap) if log is None else log
    fitted = layout.for_run(mcap.stem, log.metadata)
    check_layout(fitted, log)
    rrd, foxglove = mcap.with_suffix(".rrd"), mcap.with_suffix(FOXGLOVE_SUFFIX)
    part = foxglove.with_name(f".{foxglove.name}.part")
    eyes = eyes_of(fitted, log)
    part.write_text(foxglove_layout(fitted, log, eyes))
    part.replace(foxglove)
    _write_rrd(mcap, fitted, log, eyes, rrd)
    return [rrd, foxglove]


def _write_rrd(mcap: Path, layout: Layout, log: Log, eyes: Mapping[Scene, Eye], rrd: Path) -> None:
    """Write the ``.rrd``: the converted log, its drawings and text pages, and the blueprint in one file."""
    application, recording = f"gainsay_{layout.name}", mcap.stem
    if not re.fullmatch("[a-z0-9_]+", recording):
        # Other letters make the viewer lose the tie between recording and blueprint.
        raise InputError("name of a run", value=recording, expected="lower-case letters, digits and underscores")
    with tempfile.TemporaryDirectory(prefix="gainsay-views-") as folder:
        data, drawings, look, merged = (Path(folder, name) for name in ("a.rrd", "b.rrd", "c.rbl", "d.rrd"))
        names = ["--application-id", application, "--recording-id", recording]
        call(
            *("mcap", "convert", str(mcap), "-o", str(data), *names, "--timeline-type", "duration"),
            *("--exclude-topic-regex", "^/scene/"),
        )
        with quiet():
            import rerun as rr

            from gainsay.logs.blueprint import blueprint
            from gainsay.logs.drawing import draw

            stream = rr.RecordingStream(application, recording_id=recording, send_properties=False)
            stream.save(drawings)
            stream.set_log_time_enabled(False)
            draw(layout, log, stream)
            stream.flush()
            stream.disconnect()
            blueprint(layout, log, eyes).save(application, look)
        call("rrd", "merge", str(data), str(drawings), str(look), "-o", str(merged))
        part = rrd.with_name(f".{rrd.name}.part")
        part.write_bytes(merged.read_bytes())
        part.replace(rrd)
