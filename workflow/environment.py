"""Set up .venv from the hashed lock: whole or not at all, one process at a time, anew where it is not this folder's.

Run by `make` with the interpreter of the system, so it needs nothing but the standard library.
"""

import fcntl
import hashlib
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
OLDEST, NEWEST = (3, 11), (3, 13)
#: what pip and uv say where there is no network
UNREACHED = (
    "NewConnectionError",
    "NameResolutionError",
    "ConnectTimeoutError",
    "dns error",
    "client error (Connect)",
    "tcp connect error",
)
LONGEST = 200  # characters shown of what a command said


def fingerprint() -> str:
    """Return what a finished environment says of itself first: where it stands and what it was made of and with."""
    digest = hashlib.sha256()
    for name in ("requirements.lock", "pyproject.toml"):
        digest.update((ROOT / name).read_bytes())
    return f"{ROOT}\nPython {sys.version_info.major}.{sys.version_info.minor}\n{digest.hexdigest()}\n"


def inventory() -> list[str]:
    """Return what stands in the environment: its commands, its packages, and the files that say they are whole."""
    places = (VENV / "bin", *VENV.glob("lib/python*/site-packages"))
    entries = {path for place in places for path in place.glob("*") if path.name != "__pycache__"}
    entries |= {path for place in places for path in place.glob("*/RECORD")}
    return sorted(str(path.relative_to(VENV)) for path in entries)


def finished() -> bool:
    """Whether the environment is whole, of this lock and of this folder; a copied or moved one is not."""
    ready = VENV / "ready"
    if not ready.is_file() or not (VENV / "bin" / "python").exists():
        return False
    text = ready.read_text(encoding="utf-8")
    return text.startswith(fingerprint()) and set(text.removeprefix(fingerprint()).splitlines()) <= set(inventory())


def refuse(message: str) -> None:
    """End with one line."""
    print(message, file=sys.stderr)
    raise SystemExit(2)


def run(*command: object, doing: str) -> None:
    """Run a command quietly; where it fails, say so in a line and show the end of what it said."""
    done = subprocess.run([str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        text = done.stderr + done.stdout
        if any(word in text for word in UNREACHED):
            refuse(f"setting up .venv: {doing} failed: no package index can be reached; a network is needed this once")
        tail = " | ".join(line.strip() for line in text.strip().splitlines()[-3:])
        refuse(f"setting up .venv: {doing} failed: {tail[-LONGEST:]}")


def pinned(name: str) -> str:
    """Return the lines of one package in the lock, with its hashes."""
    lines, inside = [], False
    for line in (ROOT / "requirements.lock").read_text(encoding="utf-8").splitlines():
        inside = line.startswith(f"{name}==") or (inside and line.startswith(" "))
        if inside:
            lines.append(line)
    return "\n".join(lines) + "\n"


def build() -> None:
    """Make the environment: uv by pip and its hash, everything else by uv in a sixth of pip's time."""
    shutil.rmtree(VENV, ignore_errors=True)
    print("setting up .venv", flush=True)
    # In an activated environment `python3` is the one that has just been removed; what it was made from still stands.
    run(sys._base_executable, "-m", "venv", VENV, doing="making it")
    python, uv = VENV / "bin" / "python", VENV / "bin" / "uv"
    (VENV / "uv.txt").write_text(pinned("uv"), encoding="utf-8")
    quiet = ("--quiet", "--disable-pip-version-check")
    pip = (
        "-m",
        "pip",
        "install",
        *quiet,
        "--retries",
        "1",
        "--timeout",
        "10",
        "--require-hashes",
        "-r",
        VENV / "uv.txt",
    )
    run(python, *pip, doing="fetching uv")
    sync = ("pip", "sync", "--quiet", "--require-hashes", "--compile-bytecode", "--python", python, "requirements.lock")
    run(uv, *sync, doing="installing the lock")
    own = ("pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--python", python, "--editable", ".")
    run(uv, *own, doing="installing the project")
    run(python, "-m", "compileall", "-q", "workflow/gainsay", "papers", doing="compiling the project")
    whole = VENV / "ready.part"
    whole.write_text(fingerprint() + "".join(f"{name}\n" for name in inventory()), encoding="utf-8")
    whole.replace(VENV / "ready")


def main() -> None:
    """Set up the environment where it is not whole."""
    if not OLDEST <= sys.version_info[:2] <= NEWEST:
        refuse(
            f"Gainsay needs Python 3.11, 3.12 or 3.13, this is {sys.version.split()[0]}: set PYTHON=/path/to/python3.11"
        )
    if finished():
        return
    try:
        import ensurepip  # noqa: F401 (Debian leaves it out)
        import venv  # noqa: F401
    except ImportError:
        refuse("Gainsay needs Python's venv: install the package python3-venv")
    with (ROOT / ".venv.lock").open("w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("another process is setting up .venv: waiting for it", flush=True)
            fcntl.flock(file, fcntl.LOCK_EX)
        if not finished():
            build()


if __name__ == "__main__":
    main()
