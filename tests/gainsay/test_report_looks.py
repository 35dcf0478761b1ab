"""What a page is drawn with: contrast of its colours, pictures inside it."""

import re
from urllib.parse import unquote
from xml.etree import ElementTree as Tree

import pytest

from gainsay.report.page import FOLDER
from gainsay.report.pictures import data_uri
from gainsay.tables.models import VERDICTS


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2.2 defines it."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_contrast_of_text(scheme):
    # WCAG 2.2, 1.4.3: text of ordinary size has a contrast of 4.5 at least.
    style = (FOLDER / "style.css").read_text(encoding="utf-8")
    blocks = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    colours = dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6});", blocks[scheme]))
    assert set(VERDICTS) < set(colours)
    for ground in ("paper", "raised"):
        for name in set(colours) - {"paper", "raised", "line"}:
            light, dark = sorted((luminance(colours[name]), luminance(colours[ground])), reverse=True)
            assert (light + 0.05) / (dark + 0.05) >= 4.5, (name, ground)


@pytest.mark.parametrize(
    "text", ['<svg width="1"><text>50% #1</text></svg>', "<svg id='a'><text>\"it's\"</text></svg>"]
)
def test_a_picture_inside_a_page_is_the_same_picture(tmp_path, text):
    path = tmp_path / "figure.svg"
    path.write_text(f'<?xml version="1.0"?>\n<!-- made by -->\n{text}\n', encoding="utf-8")
    kind, _, inside = data_uri(path).partition(",")
    assert kind == "data:image/svg+xml"
    assert not set(inside) & set('"#')  # what would end an attribute or an address
    assert Tree.tostring(Tree.fromstring(unquote(inside))) == Tree.tostring(Tree.fromstring(text))


def test_a_large_drawing_gives_way_to_its_smaller_picture(tmp_path):
    drawing, picture = tmp_path / "figure.svg", tmp_path / "figure.png"
    drawing.write_text("<svg>" + "<path/>" * 40_000 + "</svg>", encoding="utf-8")
    picture.write_bytes(b"\x89PNG" + bytes(1000))
    assert data_uri(drawing).startswith("data:image/svg+xml,")
    assert data_uri(drawing, picture).startswith("data:image/png;base64,")
