from pathlib import Path


configfile: "workflow/config.yaml"


include: "workflow/rules/common.smk"


rule all:
    input:
        "results/.checked",


include: "workflow/rules/paper.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/check.smk"
