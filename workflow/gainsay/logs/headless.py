"""The Rerun viewer without a screen, a process of our own: every call to it ends, with an answer or an error."""

import socket
import subprocess
import tempfile
import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, ParamSpec, TypeVar

from gainsay.logs.quiet import quiet, rerun_binary

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

#: seconds until the viewer listens, and until it answers one call; it draws in software, beside whatever else runs
STARTS, ANSWERS = 60.0, 60.0

P = ParamSpec("P")
T = TypeVar("T")


class Viewer:
    """A viewer that is asked one thing at a time, and ended where it does not answer in time: no call waits for ever.

    Attributes
    ----------
    client : ViewerClient
        Connected to it; its methods are called through `ask` alone.
    """

    def __init__(self, process: "subprocess.Popen[bytes]", client: "ViewerClient") -> None:
        self._process, self.client = process, client

    def ask(self, call: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T:
        """Return what a method of the client answers.

        Raises
        ------
        TimeoutError
            There was no answer in time.
        OSError, RuntimeError
            The viewer ended, or refuses.
        """
        late = threading.Event()

        def end() -> None:
            late.set()
            self._process.kill()

        timer = threading.Timer(ANSWERS, end)
        timer.start()
        try:
            return call(*arguments, **named)
        except (OSError, RuntimeError) as error:
            if late.is_set():
                raise TimeoutError(f"no answer to {call.__name__} within {ANSWERS:g} s") from error
            raise
        finally:
            timer.cancel()

    def complaint(self) -> str:
        """Last error that the viewer has logged, in one line; empty without one."""
        errors = [entry.message for entry in self.ask(self.client.get_logs) if entry.level == "ERROR"]
        return " ".join(errors[-1].split()) if errors else ""


@contextmanager
def headless_viewer() -> Iterator[Viewer]:
    """Start a viewer on a free port of this machine alone and end it with the block, by its own process id.

    Raises
    ------
    LogError
        The viewer is not installed.
    OSError
        It ends at once, or does not listen in time.
    """
    with quiet() as environment, tempfile.TemporaryFile() as output:
        from rerun.experimental import ViewerClient

        port = _free_port()
        command = [rerun_binary(), "--headless", "--hide-welcome-screen", "--bind", "127.0.0.1", "--port", str(port)]
        process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
        try:
            _await(process, port, output)
            yield Viewer(process, ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy"))
        finally:
            process.kill()
            process.wait()


def _await(process: "subprocess.Popen[bytes]", port: int, output: IO[bytes]) -> None:
    limit = clock.monotonic() + STARTS
    while clock.monotonic() < limit:
        if process.poll() is not None:
            output.seek(0)
            lines = output.read().decode(errors="replace").strip().splitlines()
            raise OSError(lines[-1] if lines else f"it ended with code {process.returncode}")
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        clock.sleep(0.1)
    raise TimeoutError(f"it did not start within {STARTS:g} s")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
