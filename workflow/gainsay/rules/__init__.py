"""The rules that chain the steps of every paper, to be included by the Snakefile of a project."""

from pathlib import Path

#: what a Snakefile includes: all rules and targets
WORKFLOW = str(Path(__file__).with_name("gainsay.smk"))
