# The whole workflow of a project; its Snakefile names the configuration and includes this file.


include: "common.smk"


rule all:
    default_target: True
    input:
        (
            "results/.checked"
            if PAPERS == ALL
            else [f"results/{paper}/.checked" for paper in PAPERS]
        ),


include: "paper.smk"
include: "report.smk"
include: "check.smk"
