"""`snakemake campaigns` in a project of its own, where Snakemake has no notes on what is there."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from gainsay.cli import main

SNAKEMAKE = str(Path(sys.executable).parent / "snakemake")
TABLE = "name,kind,inputs,resolution,seed,block,chunk,claim,question\nline,scan,x=0..1,3,,3,3,,How large is it?\n"
MODULE = """import numpy as np

from gainsay.campaigns.scan import grid_scan


def doubled(case, points):
    return np.array([2 * float(point["x"]) for point in points])


CAMPAIGNS = {"line": grid_scan(("x",), "z", doubled, 1.0)}
"""


@pytest.mark.slow
def test_a_manifest_of_other_code_is_gathered_again_without_snakemakes_notes(tmp_path):
    root = tmp_path / "own"
    assert main(["new", "--project", str(root), "toy2001"]) == 0
    (root / "papers/toy2001/campaigns.csv").write_text(TABLE)
    (root / "papers/toy2001/campaigns.py").write_text(MODULE)
    folder = root / "results/toy2001/campaigns"
    folder.mkdir(parents=True)
    for file in ("line.parquet", "line.svg"):
        (folder / file).write_text("of other code")
    (folder / "line.json").write_text('{"depends_on": "of other code"}')
    done = subprocess.run(
        [SNAKEMAKE, "campaigns", "--cores", "1"], cwd=root, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("toy2001: line is gathered again, its manifest is of other tables or code\n") == 1
    manifest = json.loads((folder / "line.json").read_text())
    assert manifest["points"] == 3
    assert len(manifest["depends_on"]) == 16
