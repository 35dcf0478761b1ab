"""A campaign stands on the page of its paper once it is gathered, and no longer than its row says the same."""

import json

from gainsay.report.campaigns import campaign_views
from gainsay.tables import read_case

ROW = "luck,draws,factor=0..1,100,7,10,50,,How often is <it> so?\n"


def test_what_is_gathered_is_shown_as_long_as_the_row_is_the_same(project):
    table = project.root / "papers/toy/campaigns.csv"
    table.write_text("name,kind,inputs,resolution,seed,block,chunk,claim,question\n" + ROW)
    case = read_case(project.root, "toy")
    assert campaign_views(case) == ()
    folder = case.results / "campaigns"
    folder.mkdir(parents=True)
    row = {"name": "luck", "kind": "draws", "inputs": "factor=0..1", "resolution": "100", "seed": "7", "block": "10"}
    manifest = {**row, "points": 100, "told": {"low": "in 25 of 100", "low_low": 0.2}}
    (folder / "luck.json").write_text(json.dumps(manifest))
    (view,) = campaign_views(case)
    assert view.answers == ("in 25 of 100",)
    assert view.size == "100 points over factor=0 to 1"
    assert view.picture == ""
    (folder / "luck.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    assert campaign_views(case)[0].picture.startswith("data:image/svg+xml,")
    (folder / "luck.svg").write_bytes(b"\xff")
    assert campaign_views(case)[0].picture == ""
    for told in ([1], None, "x"):
        (folder / "luck.json").write_text(json.dumps({**manifest, "told": told}))
        assert campaign_views(case)[0].answers == ()
    (folder / "luck.json").write_text(json.dumps(manifest))
    table.write_text(table.read_text().replace(",7,", ",8,"))
    assert campaign_views(read_case(project.root, "toy")) == ()
    table.write_text(table.read_text().replace(",8,", ",7,"))
    (folder / "luck.json").write_text("{")
    assert campaign_views(read_case(project.root, "toy")) == ()
