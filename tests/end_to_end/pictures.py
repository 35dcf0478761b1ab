"""The pictures of README, from the results of a run: the page of a paper, and one of its runs in the viewer.

``make pictures`` writes both; needs chromium, and a Vulkan driver as `gainsay.logs.render` says.
"""

import tempfile
from pathlib import Path

from gainsay.logs.render import render
from gainsay.tables import find_root
from tests.end_to_end.browser import Browser, chromium

#: what is shown of them: the paper and its run, the window in which its page is seen, width of the picture of the run
PAPER, RUN, WINDOW, WIDTH = "wan2014", "nominal", (1200, 960), 1000


def main() -> None:
    """Write docs/page.png and docs/log.png."""
    from PIL import Image

    root = find_root(Path(__file__))
    binary = chromium()
    if binary is None:
        raise SystemExit("no chromium on this machine: install the package chromium")
    with tempfile.TemporaryDirectory() as folder:
        page, log = Path(folder, "page.png"), Path(folder, "log.png")
        browser = Browser(binary, Path(folder, "profile"))
        try:
            browser.open(root / "results" / PAPER / "index.html", WINDOW)
            browser.picture(page, WINDOW[1])
        finally:
            browser.close()
        found = render(root / "results" / PAPER / "logs" / f"{RUN}.rrd", log, time=500.0)
        if found.problems:
            raise SystemExit("; ".join(found.problems))
        for made in (page, log):
            image = Image.open(made).convert("RGB")
            image.thumbnail((WIDTH, WIDTH))
            image.quantize(192, dither=Image.Dither.NONE).save(root / "docs" / made.name, optimize=True)
            print(f"docs/{made.name}: {image.width}x{image.height}")


if __name__ == "__main__":
    main()
