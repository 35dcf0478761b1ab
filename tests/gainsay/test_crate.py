"""Crates: written whole from results that are whole, and refused in one line where anything in them is not."""

import hashlib
import json
import os
import random
import shutil
import sys
import zipfile

import pytest

from gainsay import cli
from gainsay.errors import InputError
from gainsay.steps import archive, views
from gainsay.steps.audit import audit
from gainsay.steps.compare import compare
from gainsay.steps.figures import figures
from gainsay.steps.page import page, results_of
from gainsay.steps.report import write_report
from gainsay.steps.simulation import simulation
from gainsay.steps.synthesis import synthesis
from gainsay.steps.verdicts import verdicts
from gainsay.tables import read_case
from tests.gainsay.crate_damage import METADATA, campaign, described

#: what docs/robustness.md says of hostile crates
TRIED = [
    {
        "what": "crates",
        "how": "a file changed as tables are, with its digests forged or not; another value, name or description in "
        "the metadata; files added; zip files cut, flipped, with entries doubled, renamed or no files",
        "fast": 20, "slow": 300, "night": 1000,
        "promise": "refused in one line, found to differ, or clean with the verdicts that it had; nothing of it is "
        "run, nothing is written outside",
    }
]  # fmt: skip
COUNT = TRIED[0]["night" if os.environ.get("GAINSAY_NIGHT") else "slow"]
SEED = 20261126
WHO = ("--responsible", "A. Reader", "--license", "CC-BY-4.0")


def _views(path, layout, log):
    """Views without the viewer, whose start takes seconds."""
    made = [path.with_suffix(".rrd"), path.with_suffix(".foxglove.json")]
    for file in made:
        file.write_text("{}")
    return made


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """The worked example, computed."""
    root = tmp_path_factory.mktemp("project") / "own"
    assert cli.main(["new", "--project", str(root), "toy2001"]) == 0
    case = read_case(root, "toy2001")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(views, "write_views", _views)
        for step in (synthesis, audit, simulation, figures, views.views, verdicts, compare, page):
            step(case)
    write_report(root, [results_of(case)])
    return root


@pytest.fixture(scope="module")
def written(project, tmp_path_factory):
    folder = tmp_path_factory.mktemp("crate") / "crate"
    assert cli.main(["--root", str(project), "export", str(folder), *WHO]) == 0
    return folder


@pytest.fixture
def crate(written, tmp_path):
    """A copy that a test may change."""
    shutil.copytree(written, tmp_path / "crate")
    return tmp_path / "crate"


def verified(crate, capsys, code):
    capsys.readouterr()
    assert cli.main(["verify", str(crate)]) == code
    said = capsys.readouterr()
    return said.out + said.err


def test_a_crate_is_clean_where_it_is_and_as_one_file(project, written, tmp_path, capsys):
    text = verified(written, capsys, 0)
    assert "toy2001: 10 claims: 7 reproduced, 1 contradicted, 1 undetermined, 1 uncheckable; 5 certificates" in text
    assert text.endswith("crate: clean\n")
    zipped = tmp_path / "crate.zip"
    assert cli.main(["--root", str(project), "export", str(zipped), "toy2001", *WHO]) == 0
    assert verified(zipped, capsys, 0).endswith("crate.zip: clean\n")


def test_equal_results_give_equal_bytes(project, written, tmp_path):
    shutil.copytree(project, tmp_path / "moved")
    for number in (1, 2):
        for name in (f"{number}.zip", str(number)):
            assert cli.main(["--root", str(tmp_path / "moved"), "export", str(tmp_path / name), *WHO]) == 0
    assert (tmp_path / "1.zip").read_bytes() == (tmp_path / "2.zip").read_bytes()
    files = {path.relative_to(written) for path in written.rglob("*") if path.is_file()}
    assert files == {path.relative_to(tmp_path / "1") for path in (tmp_path / "1").rglob("*") if path.is_file()}
    assert all((written / file).read_bytes() == (tmp_path / "1" / file).read_bytes() for file in files)
    assert str(tmp_path) not in (tmp_path / "1" / METADATA).read_text()
    assert not list(tmp_path.glob(".*"))


def test_the_metadata_say_what_who_and_with_what(written):
    """The profile of Workflow Run RO-Crates: https://www.researchobject.org/workflow-run-crate/."""
    content = json.loads((written / METADATA).read_text())
    found = {entity["@id"]: entity for entity in content["@graph"]}
    assert content["@context"][0] == "https://w3id.org/ro/crate/1.1/context"
    assert {"@id": "https://w3id.org/ro/crate/1.1"} in found[METADATA]["conformsTo"]
    run, workflow = found["#run"], found["Snakefile"]
    assert run["@type"] == "CreateAction"
    assert run["instrument"] == {"@id": "Snakefile"} == found["./"]["mainEntity"]
    assert "ComputationalWorkflow" in workflow["@type"]
    assert found[run["agent"]["@id"]] == {"@id": "#responsible", "@type": "Person", "name": "A. Reader"}
    assert run["endTime"] == json.loads((written / "results/provenance.json").read_text())["finished"]
    assert {"@id": "papers/toy2001/claims.csv"} in run["object"]
    assert {"@id": "papers/toy2001/audit.py"} in run["object"]
    assert {"@id": "results/toy2001/logs/nominal.mcap"} in run["result"]
    assert {"@id": "results/verdicts.csv"} in run["result"]
    solver = found["https://clarabel.org"]
    assert solver["softwareVersion"] == "0.11.1"  # pinned in pyproject.toml
    assert {"@id": solver["@id"]} in workflow["softwareRequirements"]
    parts = {part["@id"] for part in found["./"]["hasPart"]}
    files = {str(path.relative_to(written)) for path in written.rglob("*") if path.is_file()} - {METADATA}
    assert parts == files
    for file in files:
        assert found[file]["sha256"] == hashlib.sha256((written / file).read_bytes()).hexdigest()
        assert int(found[file]["contentSize"]) == (written / file).stat().st_size


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (lambda crate: (crate / "results/toy2001/verdicts.csv").write_text("claim\n"), "verdicts.csv: altered"),
        (lambda crate: (crate / "papers/toy2001/printed/K.csv").unlink(), "papers/toy2001/printed/K.csv: missing"),
        (lambda crate: (crate / "papers/toy2001/more.py").write_text(""), "papers/toy2001/more.py: not described"),
        (lambda crate: (crate / "results/toy2001/logs/nominal.mcap").write_bytes(b""), "nominal.mcap: altered"),
    ],
)
def test_a_damaged_crate_is_refused_by_the_file(crate, capsys, harm, said):
    harm(crate)
    text = verified(crate, capsys, 1)
    assert said in text
    assert text.endswith("crate: REFUSED\n")
    assert text.count("\n") == 2


def replaced(crate, file, old, new):
    path = crate / file
    text = path.read_text()
    assert text.count(old) == 1, (file, old)
    path.write_text(text.replace(old, new))
    described(crate, file)


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        # a verdict, with all its digests forged: judged again from the results it comes out as it was
        ("results/toy2001/verdicts.csv", ",undetermined,undetermined,", ",reproduced,undetermined,",
         "verdicts.csv: does not follow from the results"),
        # a proved number outside its proof
        ("results/toy2001/parts/synthesis.quantities.csv", "lmi.feasible,1.0,", "lmi.feasible,0.0,",
         "quantities.csv: does not follow from the results"),
        # a printed number: the certificates no longer prove what is claimed of it
        ("papers/toy2001/parameters.csv", "J,number,2.00,", "J,number,9.00,", "certificate audit-abscissa: refused"),
        # a published number
        ("results/toy2001/published.csv", ",reproduced\n", ",contradicted\n",
         "published.csv: does not follow from the results"),
        ("results/published.csv", ",reproduced\n", ",contradicted\n", "all papers: published.csv"),
    ],
)  # fmt: skip
def test_a_forged_crate_is_refused_though_every_digest_fits(crate, capsys, file, old, new, said):
    path = crate / file
    if path.read_text().count(old) > 1:  # the last one of several rows alike
        head, _, tail = path.read_text().rpartition(old)
        path.write_text(head + new + tail)
        described(crate, file)
    else:
        replaced(crate, file, old, new)
    text = verified(crate, capsys, 1)
    assert said in text
    assert "Traceback" not in text


def test_nothing_of_a_crate_is_run(crate, capsys):
    """Its modules are data: a module that would say so when run does not, and the crate is still clean."""
    for path in (crate / "papers/toy2001").glob("*.py"):
        path.write_text(path.read_text() + f"\nraise SystemExit({path.name!r})\n")
        described(crate, f"papers/toy2001/{path.name}")
    assert verified(crate, capsys, 0).endswith("clean\n")


def other(crate, change):
    content = json.loads((crate / METADATA).read_text())
    change({entity["@id"]: entity for entity in content["@graph"]}, content)
    (crate / METADATA).write_text(json.dumps(content))


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (lambda crate: shutil.rmtree(crate), "crate not found"),
        (lambda crate: (crate / METADATA).unlink(), f"no {METADATA}"),
        (lambda crate: (crate / METADATA).write_text("{"), "expected well-formed JSON"),
        (lambda crate: (crate / METADATA).write_text("[]"), "a foreign crate"),
        (lambda crate: other(crate, lambda found, _: found["./"].pop("conformsTo")), "a foreign crate"),
        (lambda crate: other(crate, lambda found, _: found["#contract"].update(version="1")), "expected version 2"),
        (lambda crate: other(crate, lambda _, content: content.update({"@graph": [1]})), "a foreign crate"),
    ],
)
def test_a_missing_or_foreign_crate_is_bad_input(crate, capsys, harm, said):
    harm(crate)
    text = verified(crate, capsys, 2)
    assert text.startswith("bad input: ")
    assert said in text
    assert text.count("\n") == 1


def test_a_zip_file_that_is_none_or_leads_outside_is_bad_input(tmp_path, capsys):
    (tmp_path / "a.zip").write_bytes(b"PK\x03\x04 no zip")
    assert "damaged" in verified(tmp_path / "a.zip", capsys, 2)
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as file:
        file.writestr("../outside.txt", "x")
    assert f"no {METADATA}" in verified(tmp_path / "b.zip", capsys, 2)
    assert not (tmp_path.parent / "outside.txt").exists()


def test_a_link_out_of_a_crate_is_no_file_of_it(crate, tmp_path, capsys):
    path = crate / "papers/toy2001/claims.csv"
    path.rename(tmp_path / "claims.csv")
    path.symlink_to(tmp_path / "claims.csv")
    assert "claims.csv: no file of the crate" in verified(crate, capsys, 1)


@pytest.mark.parametrize(
    ("harm", "arguments", "said"),
    [
        (lambda root, place: (place / "new").mkdir(), WHO, "nothing of this name there"),
        (lambda root, place: (root / "results/toy2001/verdicts.csv").unlink(), WHO, "verdicts.csv missing"),
        (lambda root, place: (root / "results/provenance.json").unlink(), WHO, "results/provenance.json: file not"),
        (lambda root, place: None, ("--responsible", " ", "--license", "MIT"), "expected a name"),
        (lambda root, place: None, ("--responsible", "A", "--license", "do as you like"), "--license"),
        (lambda root, place: None, (*WHO, "--id", "me@here"), "https://orcid.org/"),
    ],
)
def test_what_cannot_be_exported_is_said_in_one_line_and_leaves_nothing(
    project, tmp_path, capsys, harm, arguments, said
):
    root = tmp_path / "own"
    shutil.copytree(project, root)
    harm(root, tmp_path)
    before = sorted(tmp_path.glob("*"))
    capsys.readouterr()
    assert cli.main(["--root", str(root), "export", str(tmp_path / "new"), *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert sorted(tmp_path.glob("*")) == before


def test_without_the_extra_the_extra_is_named(project, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rocrate", None)
    monkeypatch.setitem(sys.modules, "rocrate.model", None)
    monkeypatch.setitem(sys.modules, "rocrate.rocrate", None)
    with pytest.raises(InputError, match=r"rocrate is not installed: .*gainsay\[crate\]"):
        archive.export([read_case(project, "toy2001")], tmp_path / "new", archive.Responsible("A", "MIT"))
    assert not list(tmp_path.iterdir())


def test_some_hostile_crates_are_refused_or_differ_or_say_the_same(written, tmp_path, capsys):
    outcomes = campaign(written, tmp_path / "tried", TRIED[0]["fast"], random.Random(SEED), capsys)
    assert outcomes[1] > 5
    assert outcomes[2] > 0


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(3))
def test_hostile_crates_are_refused_or_differ_or_say_the_same(written, tmp_path, capsys, batch):
    outcomes = campaign(written, tmp_path / "tried", COUNT // 3, random.Random(f"{SEED} {batch}"), capsys)
    print(f"hostile crates, batch {batch}: {dict(outcomes)}")
    assert outcomes[1] > COUNT // 12
    assert outcomes[2] > COUNT // 30
