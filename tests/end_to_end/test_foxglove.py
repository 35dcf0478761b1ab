"""Runs in a Foxglove-compatible viewer: the open-source studio of npm, in headless Chromium, with our layout.

The viewer is no part of the environment. Where it is wanted: ``npm ci --ignore-scripts`` in ``tests/studio``, or its
packages elsewhere and that ``node_modules`` as GAINSAY_STUDIO; without it nothing is looked at. Pictures stay beside
the test's temporary files.
"""

import base64
import colorsys
import http.server
import io
import json
import os
import re
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from gainsay.logs.foxglove import foxglove_layout
from gainsay.logs.palette import in_plots, on_both
from gainsay.logs.reader import read_log
from tests.end_to_end.browser import Browser, chromium
from tests.gainsay.demo_log import LAYOUT, write_demo

pytestmark = pytest.mark.slow

_HERE = Path(__file__).resolve().parents[1] / "studio" / "node_modules"
STUDIO = os.environ.get("GAINSAY_STUDIO", str(_HERE) if _HERE.is_dir() else "")
RESULTS = Path(__file__).resolve().parents[2] / "results"
RUNS = ("wan2014/logs/blind_start", "zhang2013/logs/nominal", "li2021/logs/proposed", "pinheiro2013/logs/a_h2_release")
PAGE = """<!doctype html><meta charset="utf-8"><style>html, body, #root { height: 100%; margin: 0; }</style>
<div id="root"></div>
<script src="/react/umd/react.production.min.js"></script>
<script src="/react-dom/umd/react-dom.production.min.js"></script>
<script>self.react = React; self["react-dom"] = ReactDOM; localStorage.clear();
localStorage.setItem("studio.profile-data", JSON.stringify({currentLayoutId: "run"}));</script>
<script src="/@foxglove/studio-base/assets/index.js"></script>
<script>(async () => {
const data = await (await fetch("layout.json")).json();
const layout = {id: "run", name: "run", permission: "CREATOR_WRITE", baseline: {data, savedAt: undefined}};
const settings = {colorScheme: SCHEME, showDebugPanels: false, hideSignInPrompt: true, launchPreference: "web",
  "ui.open-dialog-startup": false, "telemetry.telemetryEnabled": false, "telemetry.crashReportingEnabled": false};
await initI18n();
ReactDOM.render(React.createElement(App, {
  deepLinks: [`${location.origin}/?ds=remote-file&ds.url=${encodeURIComponent(location.origin + "/run.mcap")}`],
  appConfiguration: {get: key => settings[key], set: async () => {}, addChangeListener() {}, removeChangeListener() {}},
  dataSources: [new RemoteDataSourceFactory()], extensionLoaders: [], enableGlobalCss: true,
  layoutStorage: {list: async () => [layout], get: async () => layout, put: async (_, put) => put,
    delete: async () => {}, importLayouts: async () => {}},
}), document.getElementById("root"));
})();</script>"""


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serves files with byte ranges, which the viewer asks for."""

    extra: dict[str, bytes] = {}  # noqa: RUF012  # set by the test for its server

    def do_GET(self):
        path = self.path.split("?")[0]
        data = self.extra.get(path)
        if data is None:
            file = Path(STUDIO, path.lstrip("/"))
            data = file.read_bytes() if file.is_file() else None
        if data is None:
            self.send_error(404)
            return
        span = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        first, last = (int(span[1]), int(span[2] or len(data) - 1)) if span else (0, len(data) - 1)
        self.send_response(206 if span else 200)
        self.send_header("Content-Type", self.guess_type(path) if "." in path else "text/html")
        self.send_header("Accept-Ranges", "bytes")
        self.send_header("Content-Length", str(last - first + 1))
        if span:
            self.send_header("Content-Range", f"bytes {first}-{last}/{len(data)}")
        self.end_headers()
        self.wfile.write(data[first : last + 1])

    do_HEAD = do_GET

    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    binary = chromium()
    if not STUDIO or binary is None:
        # the viewer is a folder of npm packages that the project does not carry
        pytest.skip("no viewer: set GAINSAY_STUDIO, see above, and install chromium")
    opened = Browser(binary, tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


def look(browser, mcap, layout, scheme, picture):
    """Open a log with its layout and write what is seen once it has stopped changing."""
    page = PAGE.replace("SCHEME", json.dumps(scheme))

    class Served(Handler):
        extra = {  # noqa: RUF012  # one run is served
            "/": page.encode(),
            "/run.mcap": mcap.read_bytes(),
            "/layout.json": layout.encode(),
        }

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Served)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        browser.call("Emulation.setDeviceMetricsOverride", width=1600, height=900, deviceScaleFactor=1, mobile=False)
        browser.events.clear()
        browser.call("Page.navigate", url=f"http://127.0.0.1:{server.server_port}/")
        browser.wait("document.querySelectorAll('canvas').length > 0", 120)
        time.sleep(25.0)  # plots are filled once all of the log is there, which no element tells
        before, limit = b"", time.monotonic() + 60
        while time.monotonic() < limit:
            time.sleep(5.0)
            # Of the window as it is: charts begin anew where the picture asks for another size.
            shot = browser.call("Page.captureScreenshot", format="png")
            picture.write_bytes(base64.b64decode(shot["data"]))
            if picture.read_bytes() == before:
                break
            before = picture.read_bytes()
        # The title of a tab is the value of an input.
        titles = "[...document.querySelectorAll('input')].map(i => i.value).join('\\n')"
        return browser.evaluate(f"document.body.innerText + '\\n' + {titles}")
    finally:
        server.shutdown()
        server.server_close()


def seen(picture, *colours, tolerance=24):
    """Share of a picture's pixels that have one of some colours."""
    image = np.asarray(Image.open(io.BytesIO(picture.read_bytes())).convert("RGB"), dtype=int)
    return max(float((np.abs(image - colour).max(axis=2) < tolerance).mean()) for colour in colours)


def dots(name, scheme):
    """Colour of a role's dots in a plot: darker by 0.3 of lightness on a light ground, else lighter by 38."""
    colour = in_plots(name)
    if scheme == "dark":
        return np.minimum(255, np.add(colour, 38))
    hue, lightness, saturation = colorsys.rgb_to_hls(*(part / 255 for part in colour))
    return np.multiply(255, colorsys.hls_to_rgb(hue, lightness - 0.3, saturation))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_trajectory_and_curves_are_seen_in_both_themes(browser, tmp_path, scheme):
    mcap = write_demo(tmp_path / "spiral.mcap", samples=301)
    picture = tmp_path / f"{scheme}.png"
    text = look(browser, mcap, foxglove_layout(LAYOUT, read_log(mcap)), scheme, picture)
    for title in ("Approach", "demo spiral: ", "Relative position [m]", "Thrust [N]"):
        assert title in text
    assert seen(picture, on_both("truth"), tolerance=40) > 2e-4
    for name in ("axis_1", "axis_2", "axis_3"):
        assert seen(picture, dots(name, scheme)) > 1e-4, name


@pytest.mark.parametrize("run", RUNS)
def test_a_run_of_each_paper_opens_with_its_layout(browser, tmp_path, run):
    mcap, layout = RESULTS / f"{run}.mcap", RESULTS / f"{run}.foxglove.json"
    if not (mcap.is_file() and layout.is_file()):
        # results are not in the repository: this looks at those of a pipeline that has run
        pytest.skip(f"{run} is not computed here")
    picture = tmp_path / f"{mcap.stem}.png"
    text = look(browser, mcap, layout.read_text(), "light", picture)
    assert f"{mcap.parts[-3]} {mcap.stem}: " in text
    assert max(seen(picture, dots(name, "light")) for name in ("axis_1", "axis_2")) > 1e-4
