"""Campaigns on the page of a paper: what each answers, from its manifest and figure alone."""

from dataclasses import dataclass

from markupsafe import Markup, escape

from gainsay.errors import InputError
from gainsay.report.pictures import svg_uri
from gainsay.tables import Case
from gainsay.tables.files import read_json, read_text

__all__ = ["CampaignView", "campaign_views"]


@dataclass(frozen=True)
class CampaignView:
    """A campaign that has been gathered.

    Attributes
    ----------
    name, question : str
    answers : tuple of str
        What was found, a sentence each.
    size : str
        Points, and over which inputs.
    picture : Markup
        Its figure as a data URI; empty where there is none.
    """

    name: str
    question: str
    answers: tuple[str, ...]
    size: str
    picture: Markup


def campaign_views(case: Case) -> tuple[CampaignView, ...]:
    """Return the campaigns of a paper that are gathered and still are those of its table, in the table's order."""
    found = []
    for name, row in case.campaigns.items():
        manifest, picture = (case.results / "campaigns" / f"{name}.{ending}" for ending in ("json", "svg"))
        try:
            said = read_json(manifest, case.root)
        except InputError:
            continue
        same = ("name", "kind", "inputs", "resolution", "seed", "block")
        if not isinstance(said, dict) or any(said.get(key) != getattr(row, key) for key in same):
            continue
        told = said.get("told")
        answers = tuple(text for text in told.values() if isinstance(text, str)) if isinstance(told, dict) else ()
        size = f"{said.get('points')} points over {row.inputs.replace('..', ' to ')}"
        try:
            drawn = escape(svg_uri(read_text(picture, case.root)))
        except InputError:
            drawn = Markup()
        found.append(CampaignView(name, row.question, answers, size, drawn))
    return tuple(found)
