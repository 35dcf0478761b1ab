"""Pictures inside a page, so that the page can be mailed alone."""

import base64
import re
from pathlib import Path

__all__ = ["data_uri", "svg_uri"]

#: bytes of an SVG above which its PNG stands in the page where that is smaller
LARGEST_SVG = 150_000


def data_uri(svg: Path, png: Path | None = None) -> str:
    """Return a figure as a data URI: the SVG, or its PNG where the SVG is large and the PNG is smaller."""
    if png is not None and png.is_file() and LARGEST_SVG < svg.stat().st_size > 4 / 3 * png.stat().st_size:
        return f"data:image/png;base64,{base64.b64encode(png.read_bytes()).decode('ascii')}"
    # a damaged picture costs no page: that it is altered is for `gainsay check` to say
    return svg_uri(svg.read_text(encoding="utf-8", errors="replace"))


def svg_uri(text: str) -> str:
    """Return an SVG as a data URI, without what no browser draws and with paths to a hundredth of a point."""
    text = re.sub(r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), text)
    text = re.sub(r"<\?xml[^>]*\?>|<!DOCTYPE[^>]*>|<!--.*?-->|<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"\s+", " ", text).strip()
    if "'" not in text:  # quotes that need no escape in the page
        text = text.replace('"', "'")
    for character in '%#"':
        text = text.replace(character, f"%{ord(character):02X}")
    return f"data:image/svg+xml,{text}"
