"""What a paper prints is typed a second time in the tests: every number, vector, matrix and inequality, counted.

The folders ``<paper>_second_reading`` were typed from the papers' texts without sight of the tables: ``numbers.csv``
with the words around each number and the unit that stands there, and a file of the table's name for each matrix.
"""

import ast
import csv
from dataclasses import replace
from pathlib import Path

import pytest

from gainsay.tables import Case, read_case

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
PAPERS = ("li2021", "pinheiro2013", "wan2014", "zhang2013")
#: rows of status `corrected` whose digits are ours: what the paper prints instead stands in the errata
OURS = {"li2021": {"GammaD", "GammaG"}, "zhang2013": {"lambda1_corrected"}}
#: printed as products of a number and a power of n or e: test_wan2014_tables reads them
SYMBOLIC = {"wan2014": {"E1_over_e", "E2_coefficient", "E2_power"}}
#: where each paper's statements are held against what was typed afresh
SECOND = {
    "li2021": ("test_li2021_statements.py",),
    "pinheiro2013": ("test_pinheiro2013_mixed.py",),
    "wan2014": ("test_wan2014_statements.py",),
    "zhang2013": ("test_zhang2013_printed.py",),
}
#: statements of ours, that no paper prints, and editions, which are made of the printed ones
OWN = {
    "li2021": {"linear_13", "falling", "EQ12_CORRECTED", "ROTATION_32_CORRECTED", "G0_33_CORRECTED"},
    "pinheiro2013": {"corrected_21"},
    "wan2014": {"_statement", "dissipation", "_of_axis", "EQ14_CORRECTED",
                "EQ25_CORRECTED", "EQ29_CORRECTED", "EQ31_ONE_ROW", "FEEDBACK",
                "FEEDBACK_TIMES_RHO", "START_TIMES_RHO", "THRUST_TIMES_RHO", "JOINT", "JOINT_START", "MULTIPLIERS",
                "DECAY"},
    "zhang2013": {"without_slack", "without_block_26", "corrected_23", "corrected_26", "_nine"},
}  # fmt: skip
MAKERS = {"Statement", "_statement", "corrected", "sub"}


def named(tree: ast.Module) -> set[str]:
    """Names at the top of a module of a statement, or of a function that returns one."""
    names = set()
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and isinstance(node.returns, ast.Name) and node.returns.id == "Statement":
            names.add(node.name)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made_by = node.value.func
            if getattr(made_by, "id", getattr(made_by, "attr", "")) in MAKERS:
                names |= {target.id for target in node.targets}
    return names


@pytest.mark.parametrize("paper", SECOND)
def test_every_printed_statement_has_a_second_transcription(paper):
    statements = set().union(*(named(ast.parse(path.read_text())) for path in (ROOT / "papers" / paper).glob("*.py")))
    assert OWN[paper] <= statements
    typed = set()
    for file in SECOND[paper]:
        for node in ast.walk(ast.parse((ROOT / "tests" / "papers" / file).read_text())):
            typed |= {getattr(node, "id", ""), getattr(node, "attr", ""), getattr(node, "value", "")} & statements
    left_out = statements - OWN[paper] - typed
    assert not left_out


def second_numbers(paper: str) -> dict[str, dict[str, str]]:
    with (HERE / f"{paper}_second_reading" / "numbers.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = {row["parameter"]: row for row in rows}
    assert len(found) == len(rows)
    return found


def same_matrix(case: Case, name: str) -> bool:
    """Whether a printed matrix was read twice alike, digit for digit."""
    file = HERE / f"{case.name}_second_reading" / Path(case.parameters[name].value.split()[0]).name
    table = [[entry.text for entry in row] for row in case.printed(name).rows]
    return file.is_file() and list(csv.reader(file.read_text(encoding="utf-8").splitlines())) == table


def disagreements(case: Case) -> list[str]:
    """Parameters in which the tables and the second reading differ, or which stand in one of them alone."""
    numbers = second_numbers(case.name)
    apart = OURS.get(case.name, set()) | SYMBOLIC.get(case.name, set())
    printed = {
        n: row for n, row in case.parameters.items() if row.status in ("printed", "corrected") and n not in apart
    }
    found = [n for n, row in printed.items() if row.type == "matrix" and not same_matrix(case, n)]
    of_numbers = {n: row for n, row in printed.items() if row.type != "matrix"}
    for name, row in of_numbers.items():
        second = numbers.get(name, {"as_printed": "", "unit": ""})
        if row.value != second["as_printed"] or second["unit"] not in ("", row.unit):
            found.append(name)
    return found + sorted(set(numbers) - set(of_numbers))


@pytest.mark.parametrize("paper", PAPERS)
def test_every_printed_number_vector_and_matrix_was_read_twice_alike(paper):
    assert disagreements(read_case(ROOT, paper)) == []


@pytest.mark.parametrize("paper", PAPERS)
def test_one_digit_changed_in_any_printed_number_is_noticed(paper):
    case = read_case(ROOT, paper)
    for name in second_numbers(paper):
        row = case.parameters[name]
        place = max(i for i, letter in enumerate(row.value.partition("e")[0]) if letter.isdigit())
        other = f"{row.value[:place]}{(int(row.value[place]) + 1) % 10}{row.value[place + 1 :]}"
        changed = {**case.parameters, name: row.model_copy(update={"value": other})}
        assert disagreements(replace(case, parameters=changed)) == [name]


#: numbers that claims publish and no table of parameters holds: outputs that observe all 6 states in 24 cases of 64
IN_SENTENCES = {"wan2014": {24.0, 6.0}}


@pytest.mark.parametrize("paper", PAPERS)
def test_a_published_threshold_without_a_reading_was_read_twice_too(paper):
    case = read_case(ROOT, paper)
    known = {0.0, 1.0, *IN_SENTENCES.get(paper, ()), *(float(r["as_printed"]) for r in second_numbers(paper).values())}
    for claim in case.claims.values():
        if claim.published and not claim.reading and claim.comparator != "less_than":
            assert float(claim.published) in known, claim.id
