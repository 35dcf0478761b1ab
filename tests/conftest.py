"""A small project on disk that tests of tables, verdicts and steps share."""

import csv
import os
import sys
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import settings

from gainsay.tables import Case, read_case
from gainsay.tables.files import write_csv

# No example has a deadline: on a machine that others use it would be their load that is tested.
settings.register_profile("here", deadline=None)
# Continuous integration draws the same examples every time: it judges a change; new examples are searched by hand.
settings.register_profile("ci", settings.get_profile("here"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "here")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol() -> Generator[None, object, object]:
    """Let `papers` mean after a test what it meant before: a command of another project, run here, takes the name."""
    path, before = [*sys.path], {name: module for name, module in sys.modules.items() if name.split(".")[0] == "papers"}
    done = yield
    sys.path[:] = path
    if sys.modules.get("papers") is not before.get("papers"):
        for name in [name for name in sys.modules if name.split(".")[0] == "papers"]:
            del sys.modules[name]
        sys.modules.update(before)
    return done


TOY = {
    "Snakefile": "",
    "papers/toy/paper.toml": """title = "A toy"
authors = ["A. Author"]
journal = "Journal of Toys"
year = 2000
doi = "10.1000/toy"

[designs]
repaired = "a design"

[runs]
nominal = "a run"

[figures]
figure_1 = "a picture"
""",
    "papers/toy/printed/K.csv": "1.50,-2e-3\n0.1,7\n",
    "papers/toy/parameters.csv": """name,type,value,unit,where,status,plausible,note
mass,number,2.0,kg,(1),printed,,
height,number,400,km,(1),printed,,
guess,number,0.5,1,(2),assumed,0..1,left out
count,number,3,1,(2),assumed,2|3,left out
start,choice,near,1,(2),assumed,near|far,left out
K,matrix,printed/K.csv 2x2,mixed,(3),printed,,
""",
    "papers/toy/quantities.csv": """id,unit,step,meaning
audit.length,m,audit,a length
audit.other,m,audit,another length
audit.holds,1,audit,whether it holds
run.peak,N,simulation,a peak
""",
    "papers/toy/claims.csv": "id,where,kind,statement,comparator,quantity,published,unit,tolerance,expected,basis,note,"
    """weight,ocr
length,(1),ordering,it is 1.50 m,equal,audit.length,1.50,m,,reproduced,by hand,,,
bound,(2),norm-bound,it is at most 2 m,at_most,audit.other,2,m,,reproduced,by hand,,,
lmi,(3),feasibility,it is feasible,feasible,audit.holds,,1,,reproduced,by hand,,,
peak,Figure 1,trajectory,it peaks below 40 N,at_most,run.peak,40,N,,reproduced,by hand,,,
both,(2),norm-bound,both hold,all_of,bound lmi,,1,,reproduced,by hand,,,
talk,Section 1,remark,it is the best,,,,1,,uncheckable,nothing to compare with,,,
""",
    "papers/toy/errata.csv": """id,where,printed,corrected,effect,witness
sign,(1),+,-,none,audit.length
""",
    "papers/toy/not_checked.csv": "where,what,reason\n(4),a definition,nothing is claimed\n",
    "papers/toy/recorded.csv": """quantity,value,unit,class,relative,absolute,reason
audit.length,1.5,m,rounding,1e-6,1e-12,condition of a million
""",
}


EDITIONS = """
from gainsay.statements import Statement
PRINTED = Statement("(21)", "Theorem 1", ("x", "z"), {("x", "z"): "C.T", ("z", "z"): "g*eye(2)"}, {})
EDITIONS = (PRINTED.corrected({("z", "z"): "-g*eye(2)"}),)
"""


@dataclass
class Project:
    """A project folder whose files a test may change."""

    root: Path
    paper: str = "toy"

    def file(self, name: str) -> Path:
        return self.root / "papers" / self.paper / name

    def edit(self, name: str, old: str, new: str) -> None:
        """Replace text that stands exactly once in a table."""
        text = self.file(name).read_text()
        assert text.count(old) == 1, (name, old)
        self.file(name).write_text(text.replace(old, new))

    def follow_edition(self, edition: str) -> None:
        """Let the erratum follow from an edition of a statement of the paper."""
        header, *rows = csv.reader(self.file("errata.csv").read_text().splitlines())
        texts = header.index("printed"), header.index("corrected")
        rows = [["" if i in texts else cell for i, cell in enumerate(row)] + [edition] for row in rows]
        write_csv(self.file("errata.csv"), [*header, "edition"], rows)
        self.file("statements.py").write_text(EDITIONS)
        (self.root / "papers" / "__init__.py").write_text("")

    def case(self) -> Case:
        return read_case(self.root, self.paper)


@pytest.fixture
def project(tmp_path: Path) -> Project:
    """Return a small well-formed project with the paper `toy`."""
    for name, text in TOY.items():
        path = tmp_path / "project" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return Project(tmp_path / "project")
