"""A gathered campaign stands on the page of its paper as long as its manifest is of today's tables and code."""

import json

import pytest

from gainsay.report.campaigns import campaign_views
from gainsay.steps.campaign import outdated, plan_digest
from gainsay.steps.page import results_of
from gainsay.tables import read_case

ROW = "luck,draws,factor=0..1,100,7,10,50,,How often is <it> so?\n"


@pytest.fixture
def folder(project):
    """Return the folder of the campaigns of a paper that has one, not gathered yet."""
    project.file("campaigns.csv").write_text("name,kind,inputs,resolution,seed,block,chunk,claim,question\n" + ROW)
    project.file("campaigns.py").write_text("SHARE = 0.25\n")
    folder = project.case().results / "campaigns"
    folder.mkdir(parents=True)
    return folder


def gathered(project, folder):
    """Write the manifest that gathering leaves, of today's tables and code, and return it."""
    case = project.case()
    row = case.campaigns["luck"]
    manifest = {key: getattr(row, key) for key in ("name", "kind", "inputs", "resolution", "seed", "block")}
    manifest |= {"depends_on": plan_digest(case, row), "points": 100, "told": {"low": "in 25 of 100", "low_low": 0.2}}
    (folder / "luck.json").write_text(json.dumps(manifest))
    return manifest


def views(project):
    found = results_of(project.case())
    return campaign_views(found.case, found.campaigns)


def test_what_is_gathered_is_shown(project, folder):
    assert views(project) == ()
    manifest = gathered(project, folder)
    (view,) = views(project)
    assert view.answers == ("in 25 of 100",)
    assert view.size == "100 points over factor=0 to 1"
    assert view.picture == ""
    assert not view.outdated
    (folder / "luck.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    assert views(project)[0].picture.startswith("data:image/svg+xml,")
    (folder / "luck.svg").write_bytes(b"\xff")
    assert views(project)[0].picture == ""
    for told in ([1], None, "x"):
        (folder / "luck.json").write_text(json.dumps({**manifest, "told": told}))
        assert views(project)[0].answers == ()


def code(project, folder):
    # as long as before: a change must not be told by the size of a file
    project.file("campaigns.py").write_text("SHARE = 0.75\n")


def broken_code(project, folder):
    project.file("campaigns.py").write_text("SHARE =\n")


def row(project, folder):
    project.edit("campaigns.csv", ",7,", ",8,")


def no_json(project, folder):
    (folder / "luck.json").write_text("{")


def a_list(project, folder):
    (folder / "luck.json").write_text("[]")


@pytest.mark.parametrize("change", [code, broken_code, row, no_json, a_list])
def test_what_was_gathered_from_something_else_is_not_shown_and_to_be_run_again(project, folder, change):
    from gainsay.report import render_paper

    gathered(project, folder)
    assert outdated(project.case()) == []
    change(project, folder)
    forget_code()
    (view,) = views(project)
    assert view.outdated
    assert (view.answers, view.size, view.picture) == ((), "", "")
    assert outdated(project.case()) == ["luck"]
    page = render_paper(results_of(read_case(project.root, "toy")))
    assert "to be run again with <code>snakemake campaigns</code>" in page
    assert "in 25 of 100" not in page


def forget_code():
    """A step reads a file of code once: what changes it is another process."""
    from gainsay.steps import campaign, closure

    campaign._code.cache_clear()
    closure._needed.cache_clear()
