"""The page of pictures of all runs: made by `make gallery`, read by nothing else."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from gainsay.errors import LogError
from gainsay.logs.reader import read_log

_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Gainsay: every run as the viewer shows it</title>
<style>
:root { color-scheme: light dark; }
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 80rem; margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 3rem; }
figure { margin: 1rem 0 2rem; }
.tabs { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); gap: .5rem; }
img { width: 100%; height: auto; }
</style>
</head>
<body>
<h1>Every run as the viewer shows it</h1>
<p>One picture a tab. To look around in one: <code>gainsay view PAPER RUN</code>.
What was found: <a href="index.html">index</a>.</p>
"""


def gallery_page(results: Path, shown: Sequence[tuple[Path, Sequence[Path]]]) -> str:
    """Return the page.

    Parameters
    ----------
    results : Path
        Folder of the page, which pictures are named relative to.
    shown : sequence of (log, pictures)
        In order of paper and run.
    """
    parts, last = [_HEAD], ""
    for mcap, pictures in shown:
        paper = mcap.parent.parent.name
        if paper != last:
            parts.append(f"<h2>{escape(paper)}</h2>\n")
            last = paper
        try:
            about = read_log(mcap).metadata.get("about", "")
        except LogError as error:
            about = str(error)
        images = [
            f'<a href="{place}"><img loading="lazy" src="{place}" alt="{escape(mcap.stem)}, tab {number}"></a>'
            for number, place in enumerate((escape(str(file.relative_to(results))) for file in pictures), start=1)
        ]
        inside = f'<div class="tabs">{"".join(images)}</div>' if images else "<p>No picture.</p>"
        caption = f"<figcaption><strong>{escape(mcap.stem)}</strong>: {escape(about)}</figcaption>"
        parts.append(f'<figure id="{escape(f"{paper}-{mcap.stem}")}">{caption}{inside}</figure>\n')
    return "".join([*parts, "</body>\n</html>\n"])
