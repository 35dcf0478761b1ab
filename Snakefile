configfile: "workflow/config.yaml"


include: "workflow/gainsay/rules/gainsay.smk"


rule all:
    input:
        WANTED,
