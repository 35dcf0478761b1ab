"""Manifests of campaigns: what gathering leaves beside a table, and whether it belongs to today's tables and code."""

from pathlib import Path
from typing import Any

from gainsay.errors import InputError
from gainsay.tables import Case
from gainsay.tables.files import read_json

__all__ = ["current_manifest", "manifest_path"]


def manifest_path(case: Case, name: str) -> Path:
    """File of the manifest of a campaign."""
    return case.results / "campaigns" / f"{name}.json"


def current_manifest(case: Case, name: str, digest: str) -> dict[str, Any] | None:
    """Return the manifest of a campaign, or None where it is of other tables or code, or none that can be read.

    Parameters
    ----------
    case : Case
    name : str
        The campaign.
    digest : str
        Today's digest of all that its results depend on.
    """
    try:
        manifest = read_json(manifest_path(case, name), case.root)
    except InputError:
        return None
    return manifest if isinstance(manifest, dict) and manifest.get("depends_on") == digest else None
