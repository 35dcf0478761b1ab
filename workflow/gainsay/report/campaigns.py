"""Campaigns on the page of a paper: what each answers, from its manifest and figure alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from markupsafe import Markup, escape

from gainsay.errors import InputError
from gainsay.report.pictures import svg_uri
from gainsay.results.manifest import current_manifest
from gainsay.tables import Case
from gainsay.tables.files import read_text

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
    outdated : bool
        Whether it was computed from other tables or code, so that nothing of it is shown.
    """

    name: str
    question: str
    answers: tuple[str, ...] = ()
    size: str = ""
    picture: Markup = field(default_factory=Markup)
    outdated: bool = False


def campaign_views(case: Case, digests: Mapping[str, str]) -> tuple[CampaignView, ...]:
    """Return the campaigns of a paper that have been gathered, in the table's order.

    Parameters
    ----------
    case : Case
    digests : mapping of name to text
        Today's digest of all that the results of each gathered campaign depend on.
    """
    return tuple(
        _view(case, name, digests[name], row.question) for name, row in case.campaigns.items() if name in digests
    )


def _view(case: Case, name: str, digest: str, question: str) -> CampaignView:
    manifest = current_manifest(case, name, digest)
    if manifest is None:
        return CampaignView(name, question, outdated=True)
    answers_by_name = manifest.get("told")
    answers = (
        tuple(text for text in answers_by_name.values() if isinstance(text, str))
        if isinstance(answers_by_name, dict)
        else ()
    )
    size = f"{manifest.get('points')} points over {case.campaigns[name].inputs.replace('..', ' to ')}"
    try:
        picture = escape(svg_uri(read_text(case.results / "campaigns" / f"{name}.svg", case.root)))
    except InputError:
        picture = Markup()
    return CampaignView(name, question, answers, size, picture)
