import csv
import re
import runpy
import shutil
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from gainsay.errors import InputError
from gainsay.report import read_results, render_index, render_paper
from gainsay.report.claims import verdicts_of
from gainsay.report.designs import comparisons, design_matrices, gain_entries
from gainsay.report.page import FOLDER
from gainsay.steps.report import main
from gainsay.tables import read_case
from gainsay.tables.models import VERDICTS

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


def read(root: Path, papers=PAPERS, runs=EXAMPLE["RUNS_OF_FIGURES"]):
    return [read_results(read_case(root, paper), runs) for paper in papers]


@pytest.fixture
def root(tmp_path):
    return EXAMPLE["build"](tmp_path / "project")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    root = EXAMPLE["build"](tmp_path_factory.mktemp("built") / "project")
    return [(path, Page(path.read_text(encoding="utf-8"))) for path in EXAMPLE["write_pages"](root, read(root))]


def test_pages_need_nothing_but_files_beside_them(built):
    for path, page in built:
        assert not page.each("script", "iframe", "object", "form")
        ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
        assert len(ids) == len(set(ids))
        for attributes in page.each("a", "img", "use"):
            target = attributes.get("href") or attributes.get("src")
            assert not re.match(r"[a-z]+:|/", target), target
            file, _, anchor = unquote(target).partition("#")
            assert not file or (path.parent / file).is_file() or file == "verdicts.csv", target
            assert not anchor or anchor in ids, target
        assert "http" not in path.read_text(encoding="utf-8")


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
    index = built[0][1]
    assert EXAMPLE["HOSTILE"] in index.said
    assert "On the toy rendezvous & its <bounds>" in index.said


def test_the_page_says_what_is_in_the_results(built):
    said = built[0][1].said
    for claim in EXAMPLE["CLAIMS"]:
        assert claim[3] in said
        assert claim[10] in said  # the reason for the expected verdict
    for row in EXAMPLE["FOUND"]:
        assert row[5] in said
        if row[0] != "repaired.cost":  # stands behind no claim, so in short only
            assert row[1] in said
    for wanted in (
        "No X, Y satisfy (14), whatever the weights.",  # what the certificate proves
        "On faith: That the formulas are the paper's.",  # and what does not follow
        "Farkas' lemma for linear matrix inequalities",
        "eq14.feasible fails",
        "2 of 3 samples hold (at most 40 N)",
        "The outcome turns at observer_start : holds at measured, fails at zero",
        "lost.number a number that no step computed not computed by the step audit",
        "This figure is missing: the step figures did not draw it.",
        "This design is missing: the step synthesis did not make it.",
        "witness is not positive definite",
        "did not converge",
        "a drawing without numbers",
        "1 of 9 verdicts are not the ones on record: range",
        "on record: reproduced",
        "gainsay prove results/toy2001/certificates/eq14-infeasible.json",
        "rerun results/toy2001/logs/nominal.rrd",
        "nowhere not there",
    ):
        assert wanted in re.sub(r"([._-]) (?=\w)", r"\1", said), wanted


def test_a_number_near_its_bound_is_told_from_it(built):
    # 39.9999996 to six digits would read 40, the bound itself.
    assert re.search(r"peak-\s*x .*?≤ 40 N 39\.9999996 N simulated", built[0][1].said)


def test_counts_are_those_of_the_table(root):
    (found,) = read(root, ["toy2001"])
    verdicts = verdicts_of(found)
    judged = [row[2] for row in EXAMPLE["JUDGED"].values()]
    assert dict(verdicts.counts) == {verdict: judged.count(verdict) for verdict in VERDICTS}
    assert [claim for _, group in verdicts.grouped() for claim in group] != list(verdicts.claims)
    assert [verdict for verdict, _ in verdicts.grouped()][:2] == ["failed", "contradicted"]


def test_gains_say_what_is_identified_and_what_agrees(root):
    # The interval of the printed digits against the entry or its range, by hand:
    # 1,1 meets 0.0050..0.0051; 1,2 misses -0.0009; 2,1 misses 20..5000; 2,2 has nothing to compare.
    (found,) = read(root, ["toy2001"])
    assert [(e.place, e.identified, e.agrees) for e in gain_entries(found)["K"]] == [
        ("1, 1", "yes", "yes"),
        ("1, 2", "yes", "no"),
        ("2, 1", "no", "no"),
        ("2, 2", "", ""),
    ]


def test_designs_stand_beside_the_printed_one(root):
    (found,) = read(root, ["toy2001"])
    (cost,) = comparisons(found)
    assert cost.name == "cost"
    assert [str(shown).count("data") > 0 for shown in (cost.printed, *cost.others)] == [True, True, True]
    pairs = design_matrices(found, found.designs[0])
    assert [(name, printed is not None) for name, printed, _ in pairs] == [("K", True), ("L", False)]


def test_a_paper_without_results_has_its_page(built):
    bare = built[2][1].said
    assert "verdicts.csv is missing" in bare
    assert "No claim of this paper is in its table." in bare
    assert "What the paper leaves out" in bare and "Check it again" in bare


@pytest.mark.parametrize(
    "lost",
    ["verdicts.csv", "quantities.csv", "gains.csv", "failures.csv", "certificates.csv", "scans", "figures", "logs",
     "certificates", "designs", "attempts", "gallery"],
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


def test_runs_of_figures_that_are_not_known_are_said_so(root):
    assert "The runs it is drawn from are not known." in Page(render_index(read(root, runs=None))).said


def test_same_bytes_wherever_and_whenever(root, tmp_path):
    other = EXAMPLE["build"](tmp_path / "elsewhere")
    pages = [path.read_bytes() for path in EXAMPLE["write_pages"](root, read(root))]
    assert pages == [path.read_bytes() for path in EXAMPLE["write_pages"](other, read(other))]
    assert pages == [path.read_bytes() for path in EXAMPLE["write_pages"](root, read(root))]


def test_a_malformed_results_table_is_named(root):
    path = root / "results" / "toy2001" / "gains.csv"
    path.write_text("gain,row\nK,1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"results/toy2001/gains\.csv:1: header"):
        read(root)


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
    assert said == "bad input: unknown paper 'nobody1999': expected bare2002, toy2001\n"
    assert not (root / "results" / "index.html").exists()


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2.2 defines it."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_contrast_of_text(scheme):
    # WCAG 2.2, 1.4.3: text of ordinary size has a contrast of 4.5 at least.
    style = (FOLDER / "style.css").read_text(encoding="utf-8")
    blocks = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    colours = dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6});", blocks[scheme]))
    assert set(VERDICTS) < set(colours)
    for ground in ("paper", "raised"):
        for name in set(colours) - {"paper", "raised", "line"}:
            light, dark = sorted((luminance(colours[name]), luminance(colours[ground])), reverse=True)
            assert (light + 0.05) / (dark + 0.05) >= 4.5, (name, ground)
