"""The wheel in an environment of its own, outside the repository: a new project there, computed to a clean check."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
UV = Path(sys.executable).parent / "uv"


def run(*command: object, cwd: Path, path: str = "/usr/bin:/bin", code: int = 0) -> str:
    """Run a command with nothing of this project around it and return what it printed."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env={**kept, "PATH": path}, capture_output=True, text=True,
        check=False, timeout=900,
    )  # fmt: skip
    assert done.returncode == code, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """The folder with wheel and sdist, made from a copy: a build leaves files beside its sources."""
    place = tmp_path_factory.mktemp("build")
    ignore = shutil.ignore_patterns("__pycache__", "*.egg-info")
    shutil.copytree(ROOT / "workflow", place / "copy/workflow", ignore=ignore)
    shutil.copytree(ROOT / "papers", place / "copy/papers", ignore=ignore)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, place / "copy" / name)
    path = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    run(UV, "build", "--quiet", "--no-build-isolation", "--python", sys.executable, "--out-dir", place / "dist", ".",
        cwd=place / "copy", path=path)  # fmt: skip
    return place / "dist"


@pytest.mark.slow
def test_wheel_and_sdist_hold_all_of_the_library_and_no_paper(built):
    (wheel,) = built.glob("*.whl")
    (sdist,) = built.glob("*.tar.gz")
    library = {
        str(path.relative_to(ROOT / "workflow"))
        for path in (ROOT / "workflow/gainsay").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and "bench" not in path.parts
    }
    in_wheel = set(zipfile.ZipFile(wheel).namelist())
    with tarfile.open(sdist) as archive:
        in_sdist = {name.partition("/")[2] for name in archive.getnames()}
    assert library <= in_wheel
    assert {f"workflow/{file}" for file in library} <= in_sdist
    for names in (in_wheel, in_sdist):
        assert not [name for name in names if name.startswith("papers") or "/bench/" in name]


@pytest.mark.slow
def test_a_new_project_outside_the_repository_is_green_at_once(built, tmp_path):
    (wheel,) = built.glob("*.whl")
    run(UV, "venv", "--quiet", "--python", sys.executable, tmp_path / "venv", cwd=tmp_path)
    run(UV, "pip", "install", "--quiet", "--python", tmp_path / "venv/bin/python", "--constraint",
        ROOT / "requirements.lock", f"gainsay[workflow,view] @ {wheel.as_uri()}", cwd=tmp_path)  # fmt: skip
    commands, project = tmp_path / "venv/bin", tmp_path / "own"
    (project / "wheels").mkdir(parents=True)
    shutil.copy(wheel, project / "wheels")
    run(commands / "gainsay", "new", "--project", project, "toy2001", cwd=tmp_path)
    run(UV, "pip", "install", "--quiet", "--python", tmp_path / "venv/bin/python", "--constraint",
        ROOT / "requirements.lock", "--reinstall-package", "gainsay", "--requirement", "requirements.txt",
        cwd=project)  # fmt: skip
    run(commands / "gainsay", "lint", cwd=project)
    run(commands / "snakemake", "--cores", "2", cwd=project)  # not activated
    assert "toy2001: a draft" in run(commands / "gainsay", "check", cwd=project)
    run(commands / "gainsay", "record", cwd=project)
    paper = project / "papers/toy2001/paper.toml"
    paper.write_text(paper.read_text().replace("draft = true", ""))
    run(commands / "snakemake", "--cores", "2", cwd=project)
    assert "is as on record" in run(commands / "gainsay", "check", cwd=project)
    for file in ("index.html", "toy2001/index.html", "toy2001/logs/nominal.mcap", "toy2001/logs/nominal.rrd",
                 "toy2001/figures/figure_1.svg", "toy2001/certificates/audit-abscissa.json"):  # fmt: skip
        assert (project / "results" / file).stat().st_size, file
    replayed = run(commands / "gainsay", "--root", project, "replay",
                   project / "results/toy2001/logs/nominal.mcap", cwd=tmp_path)  # fmt: skip
    assert "as on file" in replayed
    # what is broken in the project is seen: it is its own code that runs
    audit = project / "papers/toy2001/plant.py"
    audit.write_text(audit.read_text().replace("A - B@K", "A + B@K"))
    assert "differences" in run(commands / "snakemake", "--cores", "2", cwd=project, code=1)
