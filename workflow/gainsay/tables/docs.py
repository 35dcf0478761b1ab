"""Schema and documentation of the input tables, generated from their models."""

import json
from typing import Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from gainsay.tables.models import TABLES, PaperFile
from gainsay.tables.units import UNITS

_HEAD = """# The tables of a paper

Generated from the models in `workflow/gainsay/tables/models.py` by `make docs`; do not edit.
A paper is a folder `papers/<paper>/` with these files. Every cell is text: numbers are exact decimals such as
`-8.8129e-4`, matrices stand digit for digit in `printed/*.csv`, one row a line, without a header.
"""


def _type(field: FieldInfo) -> str:
    annotation = field.annotation
    if get_origin(annotation) is Literal:
        return " \\| ".join(f"`{word}`" if word else "(empty)" for word in get_args(annotation))
    for metadata in field.metadata:
        pattern = getattr(metadata, "pattern", None)
        if pattern:
            return f"text matching `{pattern}`"
    named = {str: "text", int: "integer"}
    return named.get(annotation, "table of names and sentences" if "dict" in str(annotation) else "list of text")


def _table(model: type[BaseModel]) -> str:
    lines = ["| column | holds | meaning |", "| --- | --- | --- |"]
    lines += [f"| `{name}` | {_type(field)} | {field.description} |" for name, field in model.model_fields.items()]
    return "\n".join(lines)


def documents() -> dict[str, str]:
    """Return every generated document: file below the project root -> text."""
    sections = [_HEAD]
    for file, model in {"paper.toml": PaperFile, **TABLES}.items():
        sections.append(f"## `{file}`\n\n{model.__doc__}\n\n{_table(model)}\n")
    units = ", ".join(f"`{unit}`" for unit in UNITS)
    sections.append(f"## Units\n\n{units}\n")
    schemas = {file: model.model_json_schema() for file, model in {"paper.toml": PaperFile, **TABLES}.items()}
    return {
        "docs/tables.md": "\n".join(sections),
        "docs/tables.schema.json": json.dumps(schemas, indent=1, sort_keys=True) + "\n",
    }
