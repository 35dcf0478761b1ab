"""A small project with results of every sort, for tests of the page; its numbers mean nothing."""

import csv
import json
from pathlib import Path

import numpy as np

from gainsay.report import write_index, write_paper
from gainsay.results.returned import FAILURE_COLUMNS, GAIN_COLUMNS, QUANTITY_COLUMNS, VERDICT_COLUMNS
from gainsay.tables.designs import FoundDesign, write_design
from gainsay.tables.models import TABLES, columns
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS
from gainsay.verdicts.published import PUBLISHED_COLUMNS

#: what a hostile table would try; must reach the page as text
HOSTILE = "<script>alert(1)</script> & \"quotes\" 'too'"

CLAIMS = [
    # id, where, kind, statement, comparator, quantity, published, unit, tolerance, expected, basis, note
    ("poles", "(40)", "gain", "The observer gain places the poles (40) to 1e-3 1/s.", "at_most", "audit.pole_error",
     "1e-3", "1/s", "", "contradicted", "enclosures of all eigenvalues", "a lost zero in L would explain it", "", "",
     "", "", "", "misprint", "possible"),
    ("peak-x", "Section 5, first sentence", "trajectory", "The thrust along x stays below its bound of 40 N.",
     "at_most", "audit.peak_fx", "40", "N", "", "reproduced", "two integrators agree", ""),
    ("cost", "Table 1", "trajectory", "The cost of the nominal run.", "equal", "audit.cost", "1.25e6", "1", "",
     "reproduced", "quadrature state", ""),
    ("eq14", "(14)", "feasibility", r"The inequality (14) with $P \succ 0$ is feasible.", "feasible", "eq14.feasible",
     "", "1", "", "contradicted", "Farkas certificate in exact rationals", "",
     "", "", "", "", "", "gap", "excluded"),
    ("start", "Figure 4", "trajectory", "Thrusts stay within their bounds of 40 N.", "at_most", "audit.peak_fy",
     "40", "N", "", "undetermined", "depends on the start of the estimate", ""),
    ("better", "Section 6", "ordering", "The printed design is cheaper than the regulator.", "less_than", "audit.cost",
     "lqr.cost", "1", "", "contradicted", "both costs are quadrature states", "",
     "", "", "", "", "", "result", "excluded"),
    ("range", "Section 5", "trajectory", "The range is between 5 m and 10 m.", "inside", "audit.range", "5..10", "m",
     "", "reproduced", "second integrator", ""),
    ("both", "Abstract", "trajectory", "Thrusts and cost are as said.", "all_of", "peak-x cost", "", "1", "",
     "reproduced", "as good as its parts", ""),
    ("remark", "Conclusion", "remark", "The method is effective. " + HOSTILE, "", "", "", "1", "", "uncheckable",
     "nothing to hold it against", ""),
]  # fmt: skip
QUANTITIES = [
    ("audit.pole_error", "1/s", "audit", "largest distance of an eigenvalue to its matched pole"),
    ("audit.peak_fx", "N", "simulation", "largest modulus of the thrust along x"),
    ("audit.peak_fy", "N", "simulation", "largest modulus of the thrust along y"),
    ("audit.cost", "1", "simulation", "cost of the nominal run"),
    ("audit.range", "m", "simulation", "range at the end"),
    ("repaired.cost", "1", "simulation", "cost of the repaired design"),
    ("lqr.cost", "1", "simulation", "cost of the regulator"),
    ("eq14.feasible", "1", "synthesis", "whether (14) has a solution"),
    ("lost.number", "kg m^2", "audit", "a number that no step computed"),
]
FOUND = [
    ("audit.pole_error", "0.031415926535897934", "1/s", "0.0314159265", "0.0314159266", "best matching", "(40)"),
    ("audit.peak_fx", "39.999999600000002", "N", "39.9999995", "39.9999997", "event location", "logs/nominal.mcap"),
    ("audit.peak_fy", "412.5", "N", "412.4", "412.6", "event location", "logs/nominal.mcap"),
    ("audit.cost", "1250000.25", "1", "1250000.0", "1250000.5", "quadrature state", "logs/nominal.mcap"),
    ("audit.range", "-7.25e-05", "m", "", "", "state at the end", "logs/nominal.mcap"),
    ("repaired.cost", "990000.0", "1", "", "", "quadrature state", "logs/repaired.mcap"),
    ("lqr.cost", "900000.0", "1", "", "", "quadrature state", "logs/lqr.mcap"),
    ("eq14.feasible", "0.0", "1", "", "", "Farkas certificate", "certificates/eq14-infeasible.json"),
]
#: claim -> recomputed, tolerance, verdict, evidence, range_low, range_high, witness, certificate, note
JUDGED = {
    "poles": ("0.031415926535897934", "0.0", "contradicted", "enclosed", "0.0314159265", "0.0314159266",
              "audit.pole_error = 0.031415926535897934 1/s", "", "a lost zero in L would explain it"),
    "peak-x": ("39.999999600000002", "0.0", "reproduced", "simulated", "39.9999995", "39.9999997", "", "", ""),
    "cost": ("1250000.25", "5000.0", "reproduced", "simulated", "1250000.0", "1250000.5", "", "", ""),
    "eq14": ("0.0", "", "contradicted", "proved: Farkas' lemma for linear matrix inequalities", "", "",
             "No X, Y satisfy (14), whatever the weights.", "eq14-infeasible", ""),
    "start": ("", "", "undetermined", "sampled 3 (distinct 3)", "38.0", "412.5",
              "depends on observer_start: holds at measured, fails at zero", "", "holds at 120 of 256"),
    "better": ("1250000.25", "", "contradicted", "sampled", "", "", "audit.cost = 1250000.25, lqr.cost = 900000.0", "",
               ""),
    "range": ("", "", "failed", "none", "", "", "", "", "(9): did not converge; attempts in attempts/simulation.json"),
    "both": ("", "", "reproduced", "joined", "", "", "", "", ""),
    "remark": ("", "", "uncheckable", "none", "", "", "", "", "nothing in the text to hold it against"),
}  # fmt: skip
SVG = (
    '<?xml version="1.0" encoding="utf-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" height="230.4pt" '
    'viewBox="0 0 496.8 230.4" width="496.8pt"><metadata><dc:source>logs/nominal.mcap</dc:source></metadata>'
    '<path d="M20 200 C 150 -80 300 300 480 40" fill="none" stroke="#0072b2" stroke-width="2"/></svg>\n'
)


def write(path: Path, header, rows) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def tables(root: Path, paper: str, *, full: bool) -> None:
    """Write the folder of a paper."""
    folder = root / "papers" / paper
    if full:
        matrices = {"K": np.array([[0.0051, -7.1e-4], [1.125, 2.0]]), "L": np.array([[1.0]])}
        write_design(folder, "repaired", FoundDesign("a cheaper gain", "picked", matrices, True, {}, {"solves": 3}, 7))
    write(folder / "printed" / "K.csv", ["0.0050", "-7.2787e-4"], [["1.0", "2"]])
    (folder / "paper.toml").write_text(
        'title = "On the toy rendezvous & its <bounds>"\nauthors = ["A. Author", "B. Author"]\n'
        'journal = "Journal of Toys, vol. 1"\nyear = 2001\ndoi = "10.1000/toy.1"\n'
        + ('[designs]\nrepaired = "our repaired design"\nlqr = "linear-quadratic regulator"\n' if full else "")
        + '[runs]\nnominal = "printed gains, two-body plant"\nrepaired = "repaired design"\n'
        + ('[measures]\n"audit.cost" = "less {}.cost"\n' if full else "")
        + '[figures]\nfigure_2 = "Figure 2: velocities."\nfigure_3 = "Figure 3: thrusts with their bounds"\n',
        encoding="utf-8",
    )
    rows = {
        "parameters.csv": [
            ("K", "matrix", "printed/K.csv 2x2", "mixed", "(44)", "printed", "", ""),
            ("mass", "number", "200", "kg", "Section 4", "printed", "", ""),
            (
                "gravity",
                "number",
                "3.986004418e5",
                "km^3/s^2",
                "Section 4",
                "assumed",
                "398600..398601",
                "of the Earth",
            ),
            ("observer_start", "choice", "measured", "1", "Section 4", "assumed", "measured|zero", HOSTILE),
        ],
        "quantities.csv": QUANTITIES,
        "claims.csv": CLAIMS,
        "errata.csv": [
            ("eq14-double", "(14)", "two columns", "one column", "the weight counts twice", "audit.cost"),
            ("eq14-infeasible", "(14)", "feasible", "infeasible", "no gain follows", "eq14-infeasible nowhere"),
        ],
        "not_checked.csv": [("Figure 1", "coordinate frames", "a drawing without numbers")],
        "recorded.csv": [],
    }
    for name, model in TABLES.items():
        wanted = rows.get(name, []) if full or name == "parameters.csv" else []
        header = columns(model)
        write(folder / name, header, [(*row, *[""] * (len(header) - len(row))) for row in wanted])


def results(root: Path, paper: str) -> None:
    """Write result files of every sort."""
    folder = root / "results" / paper
    verdicts = []
    for claim in CLAIMS:
        recomputed, tolerance, verdict, evidence, low, high, witness, certificate, note = JUDGED[claim[0]]
        row = (*claim[:4], claim[6], recomputed, claim[7], tolerance, verdict, claim[9], evidence, low, high,
               witness, claim[5], certificate, note)  # fmt: skip
        verdicts.append((*row, *[""] * (len(VERDICT_COLUMNS) - len(row))))
    write(folder / "verdicts.csv", VERDICT_COLUMNS, verdicts)
    write(folder / "quantities.csv", QUANTITY_COLUMNS, FOUND)
    write(folder / "gains.csv", GAIN_COLUMNS, [
        ("K", 1, 1, "0.0050", "0.00495", "0.00505", "0.0050123456789", 1, "0.0050", "0.0051"),
        ("K", 1, 2, "-7.2787e-4", "-0.000727875", "-0.000727865", "-0.0009", 1, "", ""),
        ("K", 2, 1, "1.0", "0.95", "1.05", "20.0", 0, "20.0", "5000.0"),
        ("K", 2, 2, "2", "1.5", "2.5", "", "", "", ""),
    ])  # fmt: skip
    write(folder / "failures.csv", FAILURE_COLUMNS, [("simulation", "(9)", "range", "did not converge " + HOSTILE)])
    write(folder / "certificates.csv", ("certificate", "accepted", "says"), [
        ("eq14-infeasible", 1, "No X, Y satisfy (14), whatever the weights."),
        ("cost-bound", 0, "witness is not positive definite"),
    ])  # fmt: skip
    write(folder / "published.csv", PUBLISHED_COLUMNS, [
        (paper, "", "gain", "K(1,1)", "0.0050", "0.0050123456789", "", "0.005", "0.0051", "0.1234568", 1, "reproduced"),
        (paper, "", "gain", "K(1,2)", "-7.2787e-4", "-0.0009", "", "-0.0009", "-0.0009", "-17213.0", 0, "undetermined"),
        (paper, "", "gain", "K(2,1)", "1.0", "20.0", "", "20.0", "5000.0", "190.0", 0, "undetermined"),
        (paper, "", "gain", "K(2,2)", "2", "", "", "", "", "", "", "uncheckable"),
        (paper, "", "pole", "observer 1 real", "-0.25", "-0.31", "1/s", "-0.32", "-0.30", "-6.0", "", "contradicted"),
        (paper, "peak-x", "response", "audit.peak_fx", "40", "39.999999600000002", "N", "39.9999995", "39.9999997",
         "-4e-07", "", "reproduced"),
    ])  # fmt: skip
    write(
        folder / "differences.csv",
        DIFFERENCE_COLUMNS,
        [(paper, "quantity", "audit.peak_fx", "39.5", "39.999999600000002", "rounding: allowed difference 0.1")],
    )
    concluded = {"of": "feasible", "quantity": "eq14.feasible", "relation": "fails", "value": None}
    content = {"kind": "farkas", "faith": ["That the formulas are the paper's."], "conclusions": [concluded],
               "fields": {"constraints": [["(14)", "[[sym(P@A), P@B], [..., -eps*eye(2)]] < 0"], ["P", "P > 0"]]},
               "definitions": [["A", "printed('K')"]], "digest": "sha256:" + "0" * 64,
               "unknowns": {"P": {"shape": [2, 2], "structure": "symmetric"}, "eps": {}}}  # fmt: skip
    texts = {
        "certificates/eq14-infeasible.json": json.dumps(content),
        "certificates/cost-bound.json": "{",
        "scans/audit.peak_fy.json": json.dumps(SCAN),
        "attempts/simulation.json": "[]",
        "figures/figure_2.svg": SVG,
        "logs/nominal.mcap": "a log",
        "logs/nominal.rrd": "a recording",
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


SCAN = {
    "quantity": "audit.peak_fy", "seed": 0, "sequence": "Halton, seeded shift",
    "inputs": [{"name": "observer_start", "unit": "1", "values": ["measured", "zero"], "logarithmic": False},
               {"name": "gravity", "unit": "m^3/s^2", "low": 3.986e14, "high": 3.98601e14, "logarithmic": False}],
    "values": [38.0, 39.0, 412.5],
    "points": [["measured", 3.986e14], ["measured", 3.98601e14], ["zero", 3.986e14]],
    "crossings": [{"values": [38.0, 412.5], "points": [["measured", 3.986e14], ["zero", 3.986e14]]}],
    "bears_out": [],
}  # fmt: skip


def build(root: Path) -> Path:
    """Write a project with a paper full of results, `toy2001`, and one without any, `bare2002`."""
    root.mkdir(parents=True, exist_ok=True)
    (root / "Snakefile").write_text("", encoding="utf-8")
    tables(root, "toy2001", full=True)
    results(root, "toy2001")
    tables(root, "bare2002", full=False)
    return root


def write_pages(root, papers):
    """Write all pages as the steps do and return their paths, the one over all papers first."""
    return [write_index(root, papers), *(write_paper(found) for found in papers)]
