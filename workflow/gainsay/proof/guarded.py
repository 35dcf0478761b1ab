"""Checking a certificate from a stranger: in a process of its own, with an end to its time and its memory.

The budgets of `gainsay.exact.budget` refuse what is too large the same on every machine. This is the wall behind them:
python-flint cannot be interrupted from within, and ends its process when memory runs out.
"""

import faulthandler
import multiprocessing
import os
import signal
import sys
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from gainsay.errors import CertificateError, GainsayError
from gainsay.proof.checker import Proof, check_file

__all__ = ["check_file_within"]

# bytes beyond what the process holds when it begins
_MEMORY = 2 << 30


def check_file_within(path: Path, root: Path, seconds: float) -> Proof:
    """`gainsay.proof.check_file`, ended after so many seconds.

    Parameters
    ----------
    path, root : Path
    seconds : float
        Wall clock, more than zero.

    Returns
    -------
    Proof

    Raises
    ------
    CertificateError
        If it is refused, takes longer, or its process ends without an answer.
    InputError
        If the paper's tables cannot be read.
    """
    context: Any = multiprocessing.get_context("fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_work, args=(sender, path, root), daemon=True)
    child.start()
    sender.close()
    try:
        if not receiver.poll(seconds):
            raise CertificateError(f"{path.stem}: not checked within {seconds:g} s")
        answer = receiver.recv()
    except EOFError:
        child.join()
        raise CertificateError(f"{path.stem}: its check broke off ({_ending(child.exitcode)})") from None
    finally:
        child.kill()
        child.join()
        receiver.close()
    if isinstance(answer, GainsayError):
        raise answer
    return answer


def _ending(code: int | None) -> str:
    names = {-number: number.name for number in signal.Signals}
    return "out of memory" if code == -signal.SIGABRT else names.get(code or 0, f"exit code {code}")


def _work(sender: Connection, path: Path, root: Path) -> None:
    """Check in the child; what the library prints as it gives up reaches no terminal."""
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 2)
    faulthandler.disable()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends the child
    _limit_memory()
    try:
        answer: Proof | GainsayError = check_file(path, root)
    except GainsayError as error:
        answer = error
    except Exception as error:
        answer = CertificateError(f"{path.stem}: {type(error).__name__}: {error}".replace("\n", " ")[:300])
    sender.send(answer)


def _limit_memory() -> None:
    if sys.platform == "win32":
        return
    import resource

    for kind, most in ((resource.RLIMIT_AS, _held() + _MEMORY), (resource.RLIMIT_CORE, 0)):
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _held() -> int:
    """Bytes of addresses that the process holds already: a fork has those of what started it."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")
