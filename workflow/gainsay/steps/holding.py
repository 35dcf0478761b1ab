"""Who may write results: one run of the workflow at a time, and no step of a run that was killed beside it.

Both locks end with the process that holds them, however it ends, so that nothing has to be unlocked by hand.
"""

import fcntl
import os
from pathlib import Path
from typing import TextIO

from gainsay.errors import InputError

#: name of the variable by which a run tells its steps which run they belong to
RUN = "GAINSAY_RUN"
#: descriptors, open and locked as long as the process lives
_held: list[int] = []


def _opened(root: Path, name: str) -> TextIO:
    folder = root / "results"
    try:
        folder.mkdir(exist_ok=True)
        return (folder / name).open("a+", encoding="utf-8")
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(reason, file=f"results/{name}", expected="a folder that can be written") from None


def _hold(file: TextIO) -> None:
    """Keep the lock of a file, which belongs to what is open and not to the object that is closed here."""
    _held.append(os.dup(file.fileno()))
    file.close()


def _owner(file: TextIO) -> str:
    file.seek(0)
    return file.read().strip()


def hold_results(root: Path) -> None:
    """Take the results for a run of the workflow, once the steps of an earlier run that was killed have ended.

    Raises
    ------
    InputError
        If another run holds them; names its process.
    """
    file = _opened(root, ".lock")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        owner = _owner(file) or "unknown"
        file.close()
        raise InputError(
            f"another run is at work here, process {owner}", file="results", expected="one run at a time"
        ) from None
    file.truncate(0)
    file.write(f"{os.getpid()}\n")
    file.flush()
    _hold(file)
    os.environ[RUN] = str(os.getpid())
    with _opened(root, ".steps") as steps:
        try:
            fcntl.flock(steps, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("waiting for a step of an earlier run to end", flush=True)
            fcntl.flock(steps, fcntl.LOCK_EX)


def hold_as_step(root: Path) -> None:
    """Say that a step is at work; a run that begins waits for it.

    Raises
    ------
    InputError
        In a step whose run was killed before it came here, where another run has begun since: it must not write.
    """
    steps = _opened(root, ".steps")
    fcntl.flock(steps, fcntl.LOCK_SH)
    _hold(steps)
    run = os.environ.get(RUN)
    if run is None:
        return
    with _opened(root, ".lock") as file:
        if _owner(file) != run:
            raise InputError("the run of this step has ended and another is at work", file="results")
