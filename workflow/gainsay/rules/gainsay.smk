# The whole workflow of a project. Its Snakefile names the configuration, includes this file and asks for WANTED.


include: "common.smk"
include: "paper.smk"
include: "report.smk"
include: "check.smk"
include: "campaign_points.smk"
include: "campaigns.smk"


WANTED = (
    ["results/.checked"]
    if PAPERS == ALL
    else [f"results/{paper}/.checked" for paper in PAPERS]
)
