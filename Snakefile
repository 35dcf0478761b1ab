from pathlib import Path


configfile: "workflow/config.yaml"


include: "workflow/rules/common.smk"


rule all:
    input:
        (
            "results/.checked"
            if PAPERS == ALL
            else [f"results/{paper}/.checked" for paper in PAPERS]
        ),


include: "workflow/rules/paper.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/check.smk"
