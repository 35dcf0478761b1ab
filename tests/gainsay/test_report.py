import csv
import dataclasses
import json
import re
import runpy
import shutil
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from gainsay.report import read_results, render_paper
from gainsay.report.claims import verdicts_of
from gainsay.report.designs import comparisons, design_views
from gainsay.report.page import paper_page, render_index
from gainsay.report.provenance import provenance_of
from gainsay.report.published import published_view
from gainsay.steps.report import main
from gainsay.tables import find_root, paper_names, read_case
from gainsay.tables.models import VERDICTS
from gainsay.tables.sentences import sentences

EXAMPLE = runpy.run_path(str(Path(__file__).with_name("report_example.py")))
PAPERS = ("toy2001", "bare2002")
VOID = {"meta", "link", "img", "br", "wbr", "use", "path", "circle", "rect"}


class Page(HTMLParser):
    """Elements of a page, each with its attributes, text and ancestors; refuses tags that do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text: list[str] = []
        self.headings: list[int] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.text.append(data)

    def each(self, *tags: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.elements if tag in tags]

    @property
    def said(self) -> str:
        return " ".join(" ".join(self.text).replace("\u00a0", " ").split())


def read(root: Path, papers=PAPERS):
    return [read_results(read_case(root, paper)) for paper in papers]


@pytest.fixture
def root(tmp_path):
    return EXAMPLE["build"](tmp_path / "project")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    root = EXAMPLE["build"](tmp_path_factory.mktemp("built") / "project")
    return [(path, Page(path.read_text(encoding="utf-8"))) for path in EXAMPLE["write_pages"](root, read(root))]


def test_a_page_of_a_paper_needs_nothing_beside_itself(built):
    for path, page in built:
        assert not page.each("script", "iframe", "object", "form")
        ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
        assert len(ids) == len(set(ids))
        for attributes in page.each("a", "img", "use"):
            target = attributes.get("href") or attributes.get("src")
            if re.match(r"https://doi\.org/10\.|data:(image/svg\+xml|text/csv)[,;]", target):
                continue
            assert not re.match(r"[a-z]+:|/", target), target
            file, _, anchor = unquote(target).partition("#")
            if path == built[0][0]:  # the page over all papers leads to tables and to the other pages
                known = ("published.csv", "verdicts.csv", "differences.csv", "provenance.json")
                assert not file or (path.parent / file).is_file() or file in known, target
            else:
                assert not file, target
            assert file or not anchor or anchor in ids, target


def test_links_from_the_index_lead_to_claims(built):
    ids = {attributes.get("id") for _, attributes in built[1][1].elements}
    leading = [a["href"] for a in built[0][1].each("a") if a["href"].startswith("toy2001/index.html#")]
    assert leading and {href.partition("#")[2] for href in leading} <= ids


def test_pages_can_be_read_by_everybody(built):
    for _, page in built:
        assert page.each("html")[0]["lang"] == "en"
        assert all(attributes["alt"] for attributes in page.each("img"))
        assert len(page.each("caption")) == len(page.each("table"))
        assert all(attributes.get("scope") for attributes in page.each("th"))
        assert page.headings[0] == 1 and page.headings.count(1) == 1
        assert all(deeper - higher <= 1 for higher, deeper in zip(page.headings, page.headings[1:], strict=False))
        labelled = [attributes["aria-labelledby"] for _, attributes in page.elements if "aria-labelledby" in attributes]
        assert set(labelled) <= {attributes.get("id") for _, attributes in page.elements}
        assert page.each("a")[0]["href"] == "#main"


def test_text_of_tables_stays_text(built):
    assert EXAMPLE["HOSTILE"] in built[1][1].said
    for _, page in built:
        assert "On the toy rendezvous & its <bounds>" in page.said or "bare" in page.said


def test_mathematics_is_typeset_and_nothing_else_is_let_in(built):
    page = built[1][1]
    assert page.each("math") and page.each("mtable")  # of a sentence, of a certificate
    for _, other in built:
        assert "$" not in other.said
        inside = {tag for tag, _ in other.elements if tag.startswith("m") and tag not in ("main", "meta")}
        assert inside <= {"math", "mrow", "mi", "mn", "mo", "msub", "msup", "mtable", "mtr", "mtd", "mspace", "mover"}
        assert not [a for _, a in other.elements if any(name.startswith("on") for name in a)]


def test_the_page_says_what_is_in_the_results(built):
    page = built[1][1]
    said = re.sub(r"([._-]) (?=\w)", r"\1", page.said)
    behind = {attributes.get("value") for attributes in page.each("data")}
    for claim in EXAMPLE["CLAIMS"]:
        assert claim[3].split("$")[0].strip() in said
        assert claim[10] in said  # the reason for the expected verdict
    for row in EXAMPLE["FOUND"]:
        assert row[5] in said
        assert row[1] in behind or row[0] == "eq14.feasible"  # every digit stands behind the short number
    for wanted in (
        "satisfy (14), whatever the weights.",  # what the certificate proves
        "What stays on faith in each: That the formulas are the paper's.",  # and what does not follow
        "Theorem: Farkas' lemma for linear matrix inequalities.",
        "Hence the answer: no.",
        "sha256:" + "0" * 64,
        "2 of 3 samples hold (at most 40 N)",
        "Holds with observer start = measured, fails with zero, the other input kept; "
        "it holds at 2 of 3 plausible values of what the paper leaves out.",
        "not computed by the step audit",
        "This figure is missing: the step figures did not draw it.",
        "This design is not on file: gainsay search toy2001 lqr finds it.",
        "How it was found: picked (3 solves, seed 7).",
        "witness is not positive definite",
        "did not converge",
        "a drawing without numbers",
        "1 of 9 verdicts are not the ones on record: range",
        "1 number of toy2001 differs from the record, no verdict does",
        "on record: 39.5",
        "K as printed; 1 reproduced, 2 undetermined, 1 uncheckable",
        "observer, pole 1, real part",
        "gainsay prove results/toy2001/certificates/eq14-infeasible.json",
        "gainsay view toy2001 nominal",
        "nowhere not there",
    ):
        assert wanted in said, wanted


@pytest.mark.parametrize("text", ["claims together", "e-05", "0.031415926535", "(1 or 0)"])
def test_the_page_says_no_machine_words(built, text):
    for _, page in built:
        assert text not in page.said


def test_what_the_paper_says_and_what_was_found_read_forwards(root):
    (found,) = read(root, ["toy2001"])
    said = {
        view.claim.id: tuple(
            re.sub("<[^>]*>|\u00a0|&nbsp;", " ", part).split() for part in (view.published, view.recomputed)
        )
        for view in verdicts_of(found).claims
    }
    assert said["eq14"] == (["feasible"], ["infeasible"])
    assert said["both"] == (["both", "hold"], ["both", "hold"])
    assert said["better"] == (["less", "than", "900000"], ["1.25", "×", "10", "6"])
    assert said["peak-x"] == (["at", "most", "40", "N"], ["39.9999996", "N"])  # to six digits it would read 40
    assert said["range"][0] == ["5", "to", "10", "m"]
    assert said["remark"] == ([], [])


def test_counts_are_those_of_the_table(root):
    (found,) = read(root, ["toy2001"])
    verdicts = verdicts_of(found)
    judged = [row[2] for row in EXAMPLE["JUDGED"].values()]
    assert dict(verdicts.counts) == {verdict: judged.count(verdict) for verdict in VERDICTS if verdict in judged}
    assert [claim for _, group in verdicts.grouped() for claim in group] != list(verdicts.claims)
    assert [verdict for verdict, _ in verdicts.grouped()][:2] == ["failed", "contradicted"]


def test_claims_of_one_sentence_count_once_and_as_the_worst(root):
    (found,) = read(root, ["toy2001"])
    before = verdicts_of(found).counts
    together = {"peak-x", "eq14"}  # reproduced and contradicted
    claims = {
        name: claim.model_copy(update={"sentence": "one"}) if name in together else claim
        for name, claim in found.case.claims.items()
    }
    found.case = dataclasses.replace(found.case, claims=claims)
    assert verdicts_of(found).counts == {**before, "reproduced": before["reproduced"] - 1}


def test_published_numbers_stand_with_their_verdicts(root):
    (found,) = read(root, ["toy2001"])
    view = published_view(found)
    ((gain,), numbers) = (view.gains, view.numbers)
    assert [[(e.place, e.verdict) for e in row] for row in gain.rows] == [
        [("1, 1", "reproduced"), ("1, 2", "undetermined")],
        [("2, 1", "undetermined"), ("2, 2", "uncheckable")],
    ]
    assert [(n.sort, n.verdict) for n in numbers] == [("pole", "contradicted"), ("response", "reproduced")]
    assert view.total == sum(sum(found.values()) for found in view.counts.values()) == 6
    assert re.sub("<[^>]*>", "", numbers[0].difference) == "\u22126"  # (-0.31 + 0.25) / 0.01, by hand


def test_an_id_in_a_sentence_leads_to_what_it_stands_for(root):
    (found,) = read(root, ["toy2001"])
    page = paper_page(found)
    shown = page.linked("see audit.peak_fx, range-x and eq14-infeasible; $a_b$ is <b>")
    assert '<a href="#toy2001-quantity-audit.peak_fx">audit.peak_fx</a>, range-x and' in shown
    assert '<a href="#toy2001-certificate-eq14-infeasible">eq14-infeasible</a>' in shown
    assert shown.endswith("is &lt;b&gt;") and shown.count("<a ") == 2


def test_designs_stand_beside_the_printed_one(root):
    (found,) = read(root, ["toy2001"])
    (table,) = comparisons(found)
    assert table.against == ""
    assert table.designs == ("repaired", "lqr")
    ((cost),) = table.measures
    assert [outcome for _, outcome in cost.others] == ["better", "better"]  # 990000 and 900000 against 1250000, less
    repaired, lqr = design_views(found.case)
    assert [(name, printed is not None) for name, printed, _ in repaired.matrices] == [("K", True), ("L", False)]
    (_, printed, ours), _ = repaired.matrices
    assert str(printed.rows[0][0]) == "0.0050"  # the digits of printed/K.csv
    assert 'value="-0.00071"' in str(ours.rows[0][1])  # those of the design's file
    assert (lqr.file, lqr.matrices) == (None, ())


def test_a_sentence_is_told_once_by_the_weightiest_of_its_claims():
    found = verdicts_of(read_results(read_case(find_root(Path(__file__)), "li2021")))
    against = dataclasses.replace(
        found, claims=tuple(dataclasses.replace(view, verdict="contradicted") for view in found.claims)
    )
    spoken = sentences(view.claim for view in found.claims)
    assert len(spoken) < len(found.claims)
    told = [view.claim.id for view in against.weightiest]
    assert sorted(len({claim.id for claim in together} & {*told}) for together in spoken) == [1] * len(spoken)
    ordered = [view for _, group in against.grouped() for view in group if view.claim.id in told]
    assert {view.weight for view in ordered} >= {"result", "misprint"}
    assert told == [view.claim.id for view in sorted(ordered, key=lambda view: view.weight == "misprint")]


def test_the_number_behind_a_ratio_is_named():
    views = {}
    for paper in ("wan2014", "pinheiro2013"):
        for view in verdicts_of(read_results(read_case(find_root(Path(__file__)), paper))).claims:
            views[view.claim.id] = dataclasses.replace(view, verdict=view.claim.expected)  # there may be no results
    assert views["fig4-bounds"].compared.startswith("largest thrust over its bound of (5)")
    assert views["mixed-faster-than-h2"].compared.endswith("largest over the axes")  # without where its value lies
    assert not views["eq23-hinf-a-hinf-pitch"].compared  # the sentence names the norm


def test_the_index_links_the_gallery_where_there_is_one(root):
    papers = read(root, ["toy2001"])
    assert "gallery.html" not in render_index(root, papers)
    gallery = root / "results" / "gallery.html"
    gallery.touch()
    linked = render_index(root, papers)
    gallery.unlink()
    assert 'href="gallery.html"' in linked


def test_where_no_design_is_printed_the_others_are_held_against_one_of_ours(root):
    found = read_results(read_case(find_root(Path(__file__)), "pinheiro2013"))
    rows = {"a.gamma_2.h2.pitch": "0.75", "a.gamma_0.2.h2.pitch": "1.5", "a.gamma_100.h2.pitch": "0.5"}
    found.quantities = {name: {"value": value} for name, value in rows.items()}
    a, b = comparisons(found)
    assert (a.against, a.designs) == ("a_mixed", ("a_hinf", "a_h2"))
    assert (b.against, b.designs) == ("b_mixed", ("b_hinf", "b_h2"))
    (measure,) = (measure for measure in a.measures if measure.own)
    assert [outcome for _, outcome in measure.others] == ["worse", "better"]  # the less the better


def test_one_table_holds_every_design_of_li2021_and_every_measure():
    found = read_results(read_case(find_root(Path(__file__)), "li2021"))
    found.quantities = {name: {"value": "1.0"} for name in found.case.quantities}
    (table,) = comparisons(found)
    points = tuple(f"tradeoff_{number}" for number in (3, 5, 4, 1, 2))
    assert table.designs == ("repaired", *points, "best", "comparison")
    empty = {
        measure.meaning.partition(" together")[2]: [
            name for name, (value, _) in zip(table.designs, measure.others, strict=True) if not value
        ]
        for measure in table.measures
        if not all(value for value, _ in measure.others)
    }
    # a level is proved of the printed gains and of ours; that of one quadratic function is no merit of a design
    assert empty == {
        " (disk for constant variations)": ["comparison"],
        " by quadratic functions, one for the disk as well": [*points, "comparison"],
    }


def test_a_measure_is_named_by_what_its_designs_share():
    found = read_results(read_case(find_root(Path(__file__)), "pinheiro2013"))
    for measure in (measure for table in comparisons(found) for measure in table.measures):
        assert r"\gamma" not in measure.meaning, measure
        assert "reconstruction" in measure.meaning
    (wan,) = comparisons(read_results(read_case(find_root(Path(__file__)), "wan2014")))
    assert "$J$ of (4) over the horizon" in [measure.meaning for measure in wan.measures]  # without "printed gains"


def test_a_printed_matrix_of_another_name_stands_beside_ours():
    views = {view.name: view for view in design_views(read_case(find_root(Path(__file__)), "li2021"))}
    printed = {name: printed.title for name, printed, _ in views["repaired"].matrices if printed}
    assert printed == {"A": "Af, as printed", "B": "Bf, as printed", "C": "Cf, as printed"}


@pytest.mark.parametrize("paper", paper_names(find_root(Path(__file__))))
def test_every_design_of_a_paper_is_on_its_page_with_its_gains(paper):
    case = read_case(find_root(Path(__file__)), paper)
    views = design_views(case)
    assert [view.name for view in views] == list(case.paper.designs)
    for view in views:
        shown = {name: (len(ours.rows), len(ours.rows[0])) for name, _, ours in view.matrices}
        file = json.loads((case.root / "papers" / paper / "designs" / f"{view.name}.json").read_text())
        assert shown == {name: (len(rows), len(rows[0])) for name, rows in file["matrices"].items()}


def test_a_paper_without_results_has_its_page(built):
    bare = built[2][1].said
    assert "verdicts.csv is missing" in bare
    assert "No claim of this paper is in its table." in bare
    assert "What the paper leaves out" in bare and "Check it again" in bare


@pytest.mark.parametrize(
    "lost",
    ["verdicts.csv", "quantities.csv", "gains.csv", "failures.csv", "certificates.csv", "scans", "figures", "logs",
     "certificates", "attempts", "published.csv", "differences.csv"],
)  # fmt: skip
def test_any_part_may_be_missing(root, lost):
    path = root / "results" / "toy2001" / lost
    whole = Page(render_paper(read(root, ["toy2001"])[0])).said
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    (found,) = read(root, ["toy2001"])
    partial = Page(render_paper(found)).said
    assert partial != whole
    assert EXAMPLE["CLAIMS"][0][3] in partial
    if lost.endswith(".csv"):
        assert f"{lost} is missing" in partial


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("<dc:source>logs/nominal.mcap</dc:source>", "Drawn from the log of nominal."),
        ("<dc:source>logs/nominal.mcap, logs/repaired.mcap</dc:source>", "Drawn from the logs of nominal , repaired ."),
        ("<dc:source>quantities.csv</dc:source>", "Drawn from the quantities and the tables."),
        ("", "The runs it is drawn from are not known."),
    ],
)
def test_a_figure_says_by_itself_what_it_is_drawn_from(root, source, said):
    path = root / "results" / "toy2001" / "figures" / "figure_2.svg"
    path.write_text(path.read_text().replace("<dc:source>logs/nominal.mcap</dc:source>", source))
    assert said.replace(" ", "") in Page(render_paper(read(root, ["toy2001"])[0])).said.replace(" ", "")


def test_same_bytes_wherever_and_whenever(root, tmp_path):
    other = EXAMPLE["build"](tmp_path / "elsewhere")
    pages = [path.read_bytes() for path in EXAMPLE["write_pages"](root, read(root))]
    assert pages == [path.read_bytes() for path in EXAMPLE["write_pages"](other, read(other))]
    assert pages == [path.read_bytes() for path in EXAMPLE["write_pages"](root, read(root))]


def test_a_malformed_results_table_is_named_on_the_page(root):
    path = root / "results" / "toy2001" / "gains.csv"
    path.write_text("gain,row\nK,1\n", encoding="utf-8")
    said = Page(render_paper(read(root, ["toy2001"])[0])).said
    assert "gains.csv is damaged, the gains are not compared yet: results/toy2001/gains.csv:1: header" in said


def test_step_joins_the_verdicts_of_all_papers(root, capsys):
    assert main([*PAPERS, "--root", str(root)]) == 0
    with (root / "results" / "verdicts.csv").open(encoding="utf-8", newline="") as file:
        joined = list(csv.reader(file))
    with (root / "results" / "toy2001" / "verdicts.csv").open(encoding="utf-8", newline="") as file:
        own = list(csv.reader(file))
    assert joined == [["paper", *own[0]], *(["toy2001", *row] for row in own[1:])]
    assert (root / "results" / "index.html").is_file()
    assert "9 verdicts of 2 papers" in capsys.readouterr().out


def test_step_refuses_an_unknown_paper_in_one_line(root, capsys):
    assert main(["toy2001", "nobody1999", "--root", str(root)]) == 2
    said = capsys.readouterr().err
    assert said == "bad input: unknown paper 'nobody1999': expected one of bare2002, toy2001\n"
    assert not (root / "results" / "index.html").exists()


def test_what_is_not_the_same_everywhere_stands_beside_the_pages(root):
    assert main([*PAPERS, "--root", str(root)]) == 0
    results = root / "results"
    told = json.loads((results / "provenance.json").read_text(encoding="utf-8"))
    assert {"commit", "finished", "system", "processor", "kernels"} <= set(told)
    listed = (results / "report.files.csv").read_text(encoding="utf-8")
    assert "index.html" in listed and "provenance.json" not in listed
    page = (results / "index.html").read_text(encoding="utf-8")
    assert told["finished"][:10] not in page and told["system"] not in page


def test_digests_of_provenance_follow_the_tables(root):
    def tables() -> str:
        return dict(provenance_of(read(root, ["toy2001"])[0]).digests)["tables of toy2001"]

    before = tables()
    path = root / "papers" / "toy2001" / "not_checked.csv"
    path.write_text(path.read_text(encoding="utf-8") + "Figure 9,a sketch,no numbers\n", encoding="utf-8")
    assert tables() != before
