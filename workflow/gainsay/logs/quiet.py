"""Rerun without usage statistics, and where its viewer is."""

import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gainsay.errors import LogError, missing_extra


@contextmanager
def quiet() -> Iterator[dict[str, str]]:
    """Environment in which Rerun finds its usage statistics switched off.

    Rerun 0.41 has no variable for it: the switch is in its configuration, so it is given one of its own, which goes
    away afterwards. The environment of this process is changed as long as the block lasts, since the viewer client
    starts its viewer from it.
    """
    with tempfile.TemporaryDirectory(prefix="gainsay-rerun-") as folder:
        config = Path(folder, "rerun", "analytics.json")
        config.parent.mkdir()
        off = {
            "analytics_enabled": False,
            "analytics_id": "",
            "metadata": {},
            "config_file_path": str(config),
            "data_dir_path": str(Path(folder, "data")),
        }
        config.write_text(json.dumps(off))
        changed = {"XDG_CONFIG_HOME": folder, "XDG_DATA_HOME": folder, "RUST_LOG": "error"}
        if "XDG_RUNTIME_DIR" not in os.environ:
            changed["XDG_RUNTIME_DIR"] = folder  # a graphics driver complains where there is none
        before = {name: os.environ.get(name) for name in changed}
        os.environ.update(changed)
        try:
            yield dict(os.environ)
        finally:
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value


def rerun_binary() -> str:
    """Path of the viewer's executable itself: its Python wrapper would outlive or orphan it.

    Raises
    ------
    LogError
        The viewer is not installed.
    """
    for folder in sys.path:
        binary = Path(folder, "rerun_cli", "rerun.exe" if os.name == "nt" else "rerun")
        if binary.is_file():
            return str(binary)
    command = shutil.which("rerun")
    if command is None:
        raise LogError("the Rerun viewer is not installed", expected=missing_extra("rerun"))
    return command
