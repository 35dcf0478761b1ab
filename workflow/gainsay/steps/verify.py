"""Check a crate without computing: digests, certificates, and that its tables follow from its results.

Nothing of the crate is run: its modules are data here. What is checked: that every file is the one described; that the
checker accepts every certificate over the crate's tables; that the verdicts, published numbers and differences are
those that this version derives from the results; and that these are as on record.
"""

import re
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any

from gainsay.errors import InputError
from gainsay.results.listing import sha256
from gainsay.steps.archive import METADATA, RESULTS_PROFILE
from gainsay.steps.check import altered, file_differences, shared_differences
from gainsay.steps.compare import compared
from gainsay.steps.verdicts import count_verdicts, judged
from gainsay.tables import Case, paper_names, read_case
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import read_json

#: bytes of an unpacked crate at most
LARGEST = 1 << 33
#: bytes of a name of a file at most, on every common file system
LONGEST_NAME = 255
OURS = "a crate written by `gainsay export`"


@contextmanager
def _opened(crate: Path) -> Iterator[Path]:
    """Give the folder of a crate; a zip file is unpacked for as long as it is looked at."""
    if crate.is_dir():
        yield crate
        return
    if not crate.is_file():
        raise InputError("crate not found", file=str(crate), expected=OURS)
    with tempfile.TemporaryDirectory(prefix="gainsay-crate-") as folder:
        try:
            with zipfile.ZipFile(crate) as archive:
                entries = archive.infolist()
                if sum(entry.file_size for entry in entries) > LARGEST:
                    raise InputError("too large", file=str(crate), expected=f"at most {LARGEST} bytes unpacked")
                if len({entry.filename for entry in entries}) < len(entries):
                    raise InputError("a file twice", file=str(crate), expected=OURS)
                archive.extractall(folder)
        except (zipfile.BadZipFile, NotImplementedError, EOFError, RuntimeError, ValueError, OSError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"damaged: {error}", file=str(crate), expected=OURS) from None
        yield Path(folder)


def _entities(folder: Path, crate: Path) -> Mapping[str, Mapping[str, Any]]:
    """Return what the metadata describes, by name; refuses what no export of ours wrote."""
    if not (folder / METADATA).is_file():
        raise InputError(f"no {METADATA}", file=str(crate), expected=OURS)
    content = read_json(folder / METADATA, folder)
    try:
        entities = {entity["@id"]: entity for entity in content["@graph"]}  # type: ignore[index]
        conforms = {one["@id"] for one in entities["./"]["conformsTo"]}
        contract = entities[RESULTS_PROFILE]["version"]
        named = all(isinstance(name, str) and isinstance(entity, dict) for name, entity in entities.items())
        if RESULTS_PROFILE not in conforms or not named:
            raise KeyError(RESULTS_PROFILE)
    except (KeyError, TypeError, AttributeError):
        raise InputError("a foreign crate", file=str(crate), expected=OURS) from None
    if contract != CONTRACT:
        raise InputError("contract of the results", file=str(crate), value=contract, expected=f"version {CONTRACT}")
    return entities


def _is_file(entity: Mapping[str, Any]) -> bool:
    kind = entity.get("@type")
    return "File" in (kind if isinstance(kind, list) else [kind])


def _may_name(name: str) -> bool:
    """Whether a description may name a file so: inside the crate, and by what a file system takes for a name."""
    path = PurePosixPath(name)
    return (
        not path.is_absolute()
        and ".." not in path.parts
        and name.isprintable()
        and all(len(part.encode()) <= LONGEST_NAME for part in path.parts)
    )


def file_damage(folder: Path, entities: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for every file that is not as described, and for every one that is not described."""
    described = {name: entity.get("sha256") for name, entity in entities.items() if _is_file(entity)}
    for name, digest in described.items():
        path = folder / name
        if not _may_name(name) or path.is_symlink():
            yield f"{name}: no file of the crate"
        elif not path.is_file():
            yield f"{name}: missing"
        elif not isinstance(digest, str) or not re.fullmatch("[0-9a-f]{64}", digest):
            yield f"{name}: described without its digest"
        elif sha256(path) != digest:
            yield f"{name}: altered"
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if not path.is_dir() and name not in described and name != METADATA:
            yield f"{name}: not described"


def _paper(case: Case) -> tuple[list[str], str]:
    """Return what is wrong with the results of a paper, and a line that says what was checked."""
    wrong = [f"{case.name}: {file}: {how}" for _, _, file, _, how, _ in file_differences(case)]
    if wrong:
        return wrong, ""
    tables, evidence = judged(case)
    wrong += [f"{case.name}: certificate {name}: refused: {reason}" for name, reason in evidence.refused.items()]
    verdicts = tables["verdicts"]
    tables |= compared(case)
    wrong += [f"{case.name}: {file}: does not follow from the results" for file in altered(case.results, tables)]
    wrong += [f"{case.name}: {row[1]} {row[2]}: not as on record" for row in tables["differences"][1]]
    return wrong, f"{case.name}: {count_verdicts(verdicts)}; {len(evidence.certificates)} certificates accepted"


def verify(crate: Path) -> tuple[list[str], list[str]]:
    """Check a crate.

    Parameters
    ----------
    crate : Path
        A folder or a zip file.

    Returns
    -------
    wrong : list of str
        A line for all that does not hold; empty where the crate is clean. Where files are damaged nothing else was
        looked at.
    checked : list of str
        A line for the files and one for each paper.

    Raises
    ------
    InputError
        If there is no crate, it is not one of ours or of another contract, or a table in it is malformed.
    """
    with _opened(crate) as folder:
        entities = _entities(folder, crate)
        wrong = list(file_damage(folder, entities))
        if wrong:
            return wrong, []
        cases = [read_case(folder, paper) for paper in paper_names(folder)]
        if not cases:
            raise InputError("no paper", file=str(crate), expected=OURS)
        checked = [f"{sum(map(_is_file, entities.values()))} files as described, contract {CONTRACT}"]
        for case in cases:
            faults, summary = _paper(case)
            wrong += faults
            checked += [summary] * bool(summary)
        if (folder / "results" / "report.files.csv").is_file():
            wrong += [f"all papers: {file}: {how}" for _, _, file, _, how, _ in shared_differences(cases)]
        return wrong, checked
