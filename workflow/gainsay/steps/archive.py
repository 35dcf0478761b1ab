"""A run as a Workflow Run RO-Crate: what went in, what came out, with which software, and who answers for it.

The crate is a project of its own: tables, modules and results stand where they stood, so that every command works in
it; only the attempts are left out. The same results give the same bytes.
"""

import hashlib
import json
import re
import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gainsay.errors import InputError, missing_extra
from gainsay.results.listing import derived_listing
from gainsay.results.returned import read_returned
from gainsay.steps.check import LISTED, file_differences, shared_differences
from gainsay.steps.closure import LIBRARY, PAPER_MODULES, sources
from gainsay.tables import Case, paper_names
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import read_json, short_path

#: the description of a crate, and of what its results conform to
METADATA, RESULTS_PROFILE = "ro-crate-metadata.json", "#contract"
#: what a run left of itself beside its results
PROVENANCE = "results/provenance.json"
#: profiles of Workflow Run RO-Crates, and the terms that they add to those of RO-Crate 1.1
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
TERMS = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}
#: what says how a project is run, where it has it
WORKFLOW = "Snakefile"
PROJECT = (
    WORKFLOW,
    "config.yaml",
    "workflow/config.yaml",
    "profiles/default/config.yaml",
    "requirements.txt",
    "requirements.lock",
    "pyproject.toml",
    "papers/__init__.py",
    "README.md",
    "LICENSE",
    "CITATION.cff",
)
FORMATS = {
    ".csv": "text/csv",
    ".json": "application/json",
    ".html": "text/html",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".py": "text/x-python",
    ".toml": "application/toml",
    ".md": "text/markdown",
    ".txt": "text/plain",
    ".yaml": "application/yaml",
    ".mcap": "application/octet-stream",
    ".rrd": "application/octet-stream",
}
#: software -> where it is at home, and what it does for a run
SOFTWARE = {
    "python": ("https://www.python.org", "interpreter"),
    "numpy": ("https://numpy.org", "arrays"),
    "scipy": ("https://scipy.org", "Riccati equations, matrix exponentials, integrators"),
    "cvxpy": ("https://www.cvxpy.org", "programs as the solver reads them"),
    "clarabel": ("https://clarabel.org", "solver of semidefinite programs"),
    "python-flint": ("https://github.com/flintlib/python-flint", "exact arithmetic of every proof"),
    "mcap": ("https://mcap.dev", "container of the logs"),
    "matplotlib": ("https://matplotlib.org", "figures"),
    "snakemake": ("https://snakemake.github.io", "chains the steps"),
}


@dataclass(frozen=True)
class Responsible:
    """Who answers for a run, and under which licence it may be used.

    Attributes
    ----------
    name : str
    license : str
        A name of the SPDX list, such as ``CC-BY-4.0``, or an address.
    id : str
        An ORCID or ROR address; may be empty.
    """

    name: str
    license: str
    id: str = ""

    def __post_init__(self) -> None:
        """Refuse what no reader could make anything of."""
        if not self.name.strip() or not self.name.isprintable():
            raise InputError("--responsible", value=self.name, expected="a name")
        if not re.fullmatch(r"[A-Za-z0-9.+-]+|https?://\S+", self.license):
            raise InputError("--license", value=self.license, expected="a name of the SPDX list, or an address")
        if self.id and not re.fullmatch(r"https://(orcid\.org/(\d{4}-){3}\d{3}[\dX]|ror\.org/\w{9})", self.id):
            raise InputError("--id", value=self.id, expected="https://orcid.org/... or https://ror.org/...")

    def license_address(self) -> str:
        """Return the address of the licence."""
        return self.license if ":" in self.license else f"https://spdx.org/licenses/{self.license}"


def inputs(case: Case) -> Iterator[str]:
    """Yield what the results of a paper were made of, below the project root."""
    root = case.root
    yield from (file for file in PROJECT if (root / file).is_file())
    for path in case.folder.rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts and not path.name.startswith("."):
            yield short_path(path, root)
    code = {file for step in PAPER_MODULES for file in sources(root, step, case.name)}
    if LIBRARY.is_relative_to(root):
        code |= {short_path(path, root) for kind in ("rules/**/*", "report/templates/*") for path in LIBRARY.glob(kind)}
    yield from (file for file in code if not Path(file).is_absolute() and (root / file).is_file())


def outputs(case: Case) -> Iterator[str]:
    """Yield what the steps left of a paper, below the project root, with the lists of it."""
    for step in LISTED:
        listing = case.results / "parts" / f"{step}.files.csv"
        lists = [listing, derived_listing(listing, case.results)]
        files = [case.results / row["file"] for row in read_returned(listing, case.root)]
        yield from (short_path(path, case.root) for path in [*lists, *files] if path.is_file())


def shared(root: Path) -> Iterator[str]:
    """Yield what the report left over all papers, below the project root."""
    yield "results/report.files.csv"
    for row in read_returned(root / "results" / "report.files.csv", root):
        yield f"results/{row['file']}"


def _run(root: Path) -> tuple[str, dict[str, str]]:
    """Return when the run ended, and the versions of what computed it."""
    content = read_json(root / PROVENANCE, root)
    entity = content if isinstance(content, dict) else {}
    finished, versions = entity.get("finished"), entity.get("versions")
    if not isinstance(finished, str) or not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00", finished):
        raise InputError(file=PROVENANCE, field="finished", value=finished, expected="a time; made by the step report")
    if not isinstance(versions, dict) or not versions:
        raise InputError(file=PROVENANCE, field="versions", expected="those of a run; made by the step report")
    return finished, {str(name): str(version) for name, version in versions.items()}


def export(cases: Sequence[Case], crate: Path, responsible: Responsible) -> str:
    """Write a crate, whole or not at all.

    Parameters
    ----------
    cases : sequence of Case
        With results that are as their steps left them; tables over all papers go along where these are all.
    crate : Path
        A new folder, or a new file that ends in ``.zip``.
    responsible : Responsible

    Returns
    -------
    str
        What was written, one line.

    Raises
    ------
    InputError
        If there is something of this name, a file of the results is damaged or missing, or rocrate is not installed.
    """
    if crate.exists() or crate.is_symlink():
        raise InputError("crate", file=str(crate), expected="nothing of this name there")
    if not crate.parent.is_dir():
        raise InputError("crate", file=str(crate), expected="a folder to put it in")
    root = cases[0].root
    whole = {case.name for case in cases} == set(paper_names(root))
    damaged = [row for case in cases for row in file_differences(case)] + (list(shared_differences(cases)) * whole)
    if damaged:
        paper, _, file, _, how, made = damaged[0]
        raise InputError(
            f"{file} {how}", file=f"results of {paper}", expected=f"files as their steps left them; {made}"
        )
    run = _run(root)
    went_in = sorted({file for case in cases for file in inputs(case)})
    came_out = sorted(
        {file for case in cases for file in outputs(case)} | set(shared(root) if whole else ()) | {PROVENANCE}
    )
    metadata = _metadata(root, [case.name for case in cases], went_in, came_out, run, responsible)
    files = {METADATA: json.dumps(metadata, indent=1, sort_keys=True, ensure_ascii=False).encode() + b"\n"}
    with tempfile.TemporaryDirectory(dir=crate.parent, prefix=f".{crate.name}.") as place:
        made_at = Path(place, crate.name)
        write = _zipped if crate.suffix == ".zip" else _copied
        write(root, made_at, files, [*went_in, *came_out])
        made_at.rename(crate)
    return f"{crate}: {', '.join(case.name for case in cases)}: {len(went_in)} inputs, {len(came_out)} outputs"


def _copied(root: Path, folder: Path, made: Mapping[str, bytes], files: Iterable[str]) -> None:
    folder.mkdir()
    for file in files:
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / file, folder / file)
    for file, content in made.items():
        (folder / file).write_bytes(content)


def _zipped(root: Path, path: Path, made: Mapping[str, bytes], files: Iterable[str]) -> None:
    """Write a zip file in which nothing tells when or by whom it was written."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in [*made, *files]:
            entry = zipfile.ZipInfo(file, (1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, made[file] if file in made else (root / file).read_bytes())


def _about(path: Path, file: str) -> dict[str, Any]:
    """Describe a file of a crate."""
    data = path.read_bytes()
    about: dict[str, Any] = {
        "name": file,
        "contentSize": str(len(data)),
        "sha256": hashlib.sha256(data).hexdigest(),
    }
    if path.suffix in FORMATS:
        about["encodingFormat"] = FORMATS[path.suffix]
    if file == WORKFLOW:
        about |= {"name": "Workflow of Gainsay", "encodingFormat": "text/plain"}
        about["@type"] = ["File", "SoftwareSourceCode", "ComputationalWorkflow"]
    return about


def _metadata(
    root: Path,
    papers: Sequence[str],
    went_in: Sequence[str],
    came_out: Sequence[str],
    run: tuple[str, Mapping[str, str]],
    by: Responsible,
) -> dict[str, Any]:
    try:
        from rocrate.model import ContextEntity
        from rocrate.rocrate import ROCrate
    except ImportError:
        raise InputError("rocrate is not installed", expected=missing_extra("rocrate")) from None

    crate = ROCrate(version="1.1")
    crate.metadata.extra_terms.update(TERMS)
    named, (finished, versions) = ", ".join(papers), run

    def thing(at: str, kind: str, /, **properties: Any) -> Any:
        return crate.add(ContextEntity(crate, at, {"@type": kind, **properties}))

    profiles = [thing(at, "CreativeWork", name=name, version=at.rsplit("/", 1)[1]) for at, name in PROFILES.items()]
    contract = thing(RESULTS_PROFILE, "CreativeWork", name="Contract of the results of Gainsay", version=CONTRACT)
    license_ = thing(by.license_address(), "CreativeWork", name=by.license, description="licence of tables and results")
    kind = "Organization" if "ror.org" in by.id else "Person"
    agent = thing(by.id or "#responsible", kind, name=by.name)
    software = []
    for name, version in versions.items():
        home, role = SOFTWARE.get(name, (f"#{name}", "what computed and checked"))
        about = {"name": name, "softwareVersion": version, "description": role}
        software.append(thing(home, "SoftwareApplication", **about, **({} if home.startswith("#") else {"url": home})))
    language = thing(
        "https://w3id.org/workflowhub/workflow-ro-crate#snakemake",
        "ComputerLanguage",
        name="Snakemake",
        alternateName="Snakemake",
        identifier={"@id": "https://doi.org/10.1093/bioinformatics/bty350"},
        url={"@id": "https://snakemake.github.io"},
    )
    files = {
        file: crate.add_file(root / file, file, properties=_about(root / file, file)) for file in [*went_in, *came_out]
    }
    workflow = files[WORKFLOW]
    if "README.md" in files:
        files["README.md"]["about"] = crate.root_dataset
    workflow["version"] = versions.get("gainsay", "unknown")
    workflow["programmingLanguage"], workflow["softwareRequirements"] = language, software
    action = thing(
        "#run",
        "CreateAction",
        name=f"Recomputation of {named}",
        instrument=workflow,
        agent=agent,
        endTime=finished,
        description="Synthesis, audit, simulation, figures and verdicts, from the tables of each paper",
        actionStatus="http://schema.org/CompletedActionStatus",
        object=[files[file] for file in went_in],
        result=[files[file] for file in came_out],
    )
    top = crate.root_dataset
    top["name"] = f"{named}, recomputed"
    top["description"] = "Tables, modules, results, certificates and logs of a run of Gainsay; check: gainsay verify"
    top["datePublished"], top["license"], top["author"] = finished, license_, agent
    top["conformsTo"], top["mainEntity"], top["mentions"] = [*profiles, contract], workflow, action
    crate.metadata["conformsTo"] = [{"@id": crate.metadata.profile}, profiles[-1]]
    return crate.metadata.generate()
