"""Evaluate one chunk of a campaign, or gather all: what the workflow runs, here or on a cluster.

A chunk stands in a folder named by a digest of all that its numbers depend on: the tables, the code as it is imported
(comments and the words of docstrings aside) and the libraries. Results of other tables are never mixed, and are there
again when the tables are as they were.
"""

import argparse
import gc
import hashlib
import os
import sys
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import CodeType
from typing import TYPE_CHECKING

from gainsay.errors import InputError, one_of
from gainsay.results.manifest import current_manifest, manifest_path
from gainsay.steps.closure import closure
from gainsay.steps.command import CLEAN, broken_off, refuse, whole_streams
from gainsay.steps.modules import paper_module
from gainsay.tables import Case, find_root, read_case
from gainsay.tables.campaigns import named
from gainsay.tables.files import read_bytes
from gainsay.tables.models import Campaign

if TYPE_CHECKING:  # planning a run must not load solvers
    from gainsay.campaigns import Plan

#: libraries whose numbers stand in results
LIBRARIES = ("clarabel", "cvxpy", "numpy", "pyarrow", "python-flint", "scipy")
#: columns of a campaign's row that its numbers depend on; chunks are cut as one likes
_COLUMNS = ("name", "kind", "inputs", "resolution", "seed", "block")
_DIGITS = 16


def collect_seldom() -> None:
    """Look for cycles of objects less often: proofs make many small numbers and none, and looking takes a twentieth."""
    gc.set_threshold(50_000, 20, 20)


@cache
def _code(path: Path) -> str:
    """Return what a module does, without what does nothing: comments, the words of docstrings, layout.

    Raises
    ------
    SyntaxError
        If it cannot be parsed.
    """
    # level 2 leaves out docstrings, and asserts, which change no number
    compiled = compile(path.read_bytes(), path.name, "exec", dont_inherit=True, optimize=2)
    return hashlib.sha256(repr(_plain(compiled)).encode()).hexdigest()


def _plain(part: object) -> object:
    """Return a constant of compiled code in a form whose text is the same in every process, code without its lines."""
    if isinstance(part, CodeType):
        names = part.co_name, part.co_names, part.co_varnames, part.co_freevars, part.co_cellvars
        arguments = part.co_argcount, part.co_posonlyargcount, part.co_kwonlyargcount, part.co_flags
        return names, arguments, part.co_code, part.co_exceptiontable, _plain(part.co_consts)
    if isinstance(part, tuple):
        return tuple(map(_plain, part))
    if isinstance(part, frozenset):  # its order differs from process to process
        return "frozenset", sorted(repr(_plain(one)) for one in part)
    return part


def plan_digest(case: Case, row: Campaign) -> str:
    """Return the digest of all that the results of a campaign depend on.

    Raises
    ------
    InputError
        If the paper's module `campaigns` cannot be parsed.
    """
    digest = hashlib.sha256()
    try:
        modules = closure(case.root, ["gainsay.campaigns", "gainsay.campaigns.store", f"papers.{case.name}.campaigns"])
        codes = sorted(_code(path) for path in modules)
    except SyntaxError as error:
        file = f"papers/{case.name}/campaigns.py"
        raise InputError(str(error), file=file, expected="a module that can be read") from None
    digest.update(repr([(name, getattr(row, name)) for name in _COLUMNS]).encode())
    parameters = [(p.name, p.type, p.value, p.unit, p.status, p.plausible) for p in case.parameters.values()]
    digest.update(repr(parameters).encode())
    for folder in ("printed", "designs"):
        for path in sorted((case.folder / folder).glob("*")):
            if path.suffix in (".csv", ".json"):
                digest.update(path.name.encode() + read_bytes(path, case.root))
    digest.update(repr(codes).encode())
    digest.update(repr([(name, version(name)) for name in LIBRARIES]).encode())
    return digest.hexdigest()[:_DIGITS]


def gathered_digests(case: Case) -> dict[str, str]:
    """Return today's digest of every campaign of a paper that has been gathered; empty where its code cannot be read.

    Working out a digest takes longer than reading a manifest: what is not gathered costs nothing.
    """
    digests = {}
    for name, row in case.campaigns.items():
        if os.path.lexists(manifest_path(case, name)):
            try:
                digests[name] = plan_digest(case, row)
            except InputError:
                digests[name] = ""
    return digests


def outdated(case: Case) -> list[str]:
    """Return the campaigns of a paper whose manifest belongs to other tables or code, or cannot be read."""
    digests = gathered_digests(case)
    return [name for name, digest in digests.items() if current_manifest(case, name, digest) is None]


def plan_of(case: Case, name: str) -> "Plan":
    """Return a campaign of a paper, ready to be evaluated.

    Raises
    ------
    InputError
        If the table or the paper's module `campaigns` has none of this name, or the two do not fit.
    """
    from gainsay.campaigns import Plan

    row = named(case.campaigns, name, f"papers/{case.name}/campaigns.csv")
    known = paper_module(case, "campaigns").CAMPAIGNS
    if name not in known:
        file = f"papers/{case.name}/campaigns.py"
        raise InputError("CAMPAIGNS", file=file, value=name, expected=one_of(name, known))
    return Plan(case, row, known[name], plan_digest(case, row))


def chunk(case: Case, name: str, number: int, digest: str = "") -> str:
    """Evaluate one chunk and write it; return what was found, for people.

    Raises
    ------
    InputError
        If the digest is not that of today's tables and code: they changed since the job was submitted.
    """
    from gainsay.campaigns.store import write_chunk

    plan = plan_of(case, name)
    if digest and digest != plan.digest:
        raise InputError(f"{name}: tables or code changed since", value=digest, expected=f"{plan.digest}; run again")
    counts = write_chunk(plan, number)
    return f"{name}, chunk {number + 1} of {plan.chunks}: " + ", ".join(f"{v} {k}" for k, v in counts.items())


def gather_all(case: Case, name: str) -> str:
    """Join all chunks of a campaign, write its manifest and figure; return what it says, for people."""
    from gainsay.campaigns.figure import draw
    from gainsay.campaigns.store import gather

    plan = plan_of(case, name)
    manifest = gather(plan)
    draw(plan)
    return f"{name}: " + "; ".join(text for text in manifest["told"].values() if isinstance(text, str))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one job of a campaign and return the exit code."""
    whole_streams()
    parser = argparse.ArgumentParser(description=__doc__, epilog="exit codes: 0 done, 2 bad input")
    parser.add_argument("paper", help="folder name below papers/")
    parser.add_argument("campaign", help="name of a campaign of campaigns.csv")
    parser.add_argument("--chunk", type=int, metavar="NUMBER", help="evaluate this chunk; default: gather all")
    parser.add_argument("--digest", default="", help="refuse where tables and code have another digest")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    options = parser.parse_args(arguments)
    collect_seldom()
    try:
        case = read_case(find_root(options.root), options.paper)
        if options.chunk is None:
            summary = gather_all(case, options.campaign)
        else:
            summary = chunk(case, options.campaign, options.chunk, options.digest)
    except InputError as error:
        return refuse(error)
    except OSError as error:
        return broken_off(error)
    print(f"{case.name}  campaign    {summary}", flush=True)
    return CLEAN


if __name__ == "__main__":
    sys.exit(main())
