"""Every inequality that a paper prints is typed a second time in the tests; this one counts that none is left out."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: where each paper's statements are held against what was typed afresh
SECOND = {
    "li2021": ("test_li2021_statements.py",),
    "pinheiro2013": ("test_pinheiro2013_mixed.py",),
    "wan2014": ("test_wan2014_statements.py",),
    "zhang2013": ("test_zhang2013_printed.py",),
}
#: statements of ours, that no paper prints, and editions, which are made of the printed ones
OWN = {
    "li2021": {"linear_13", "falling", "EQ12_CORRECTED"},
    "pinheiro2013": {"corrected_21"},
    "wan2014": {"_statement", "dissipation", "_of_axis", "EQ25_CORRECTED", "EQ29_CORRECTED", "EQ31_ONE_ROW", "FEEDBACK",
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
