"""The page in a real browser."""

import base64
import os
import re
import runpy
from pathlib import Path

import pytest

from gainsay.report import read_results, write_index, write_paper
from gainsay.tables import find_root, read_case
from tests.end_to_end.browser import PHONE, Browser, chromium

pytestmark = pytest.mark.slow

EXAMPLE = runpy.run_path(str(Path(__file__).parents[1] / "gainsay" / "report_example.py"))
DESK = (1400, 900)
SCHEMES = ("light", "dark")
#: text that a reader sees, box by box, that sticks out of the window
OVERFLOW = """
(() => {
  const wide = document.documentElement.clientWidth, found = [];
  if (document.documentElement.scrollWidth > wide) found.push('page: ' + document.documentElement.scrollWidth);
  for (const e of document.body.querySelectorAll('*')) {
    const r = e.getBoundingClientRect();
    if (!r.width || !r.height || e.closest('.scroll, .formulas dd > *, pre, .skip, thead, .symbols')) continue;
    if (r.right > wide + 0.5) found.push(e.tagName + '.' + e.className + ' ' + r.right);
  }
  return found.slice(0, 10);
})()
"""
OPEN_ALL = "document.querySelectorAll('details').forEach(d => { d.open = true; }), true"
#: links of a page that lead to a file, which a page mailed alone does not have
DEAD_LINKS = """
[...document.querySelectorAll('a[href]')].map(a => a.getAttribute('href'))
  .filter(h => !/^(#|https:\\/\\/doi\\.org\\/|data:text\\/csv)/.test(h))
"""
#: where the first mark of each verdict stands
MARKS = """
Object.fromEntries(['reproduced', 'contradicted', 'undetermined', 'uncheckable', 'failed'].map(v => {
  const r = document.querySelector('.mark-' + v).getBoundingClientRect();
  return [v, [r.x + scrollX, r.y + scrollY]];
}))
"""
#: bytes of a page that is mailed, sheets of paper
MOST_BYTES = 2_000_000
MOST_PRINTED = {"wan2014": 15, "results": 8}
#: cells whose text lies on their own label, where a table is a pile of cards
COVERED = """
[...document.querySelectorAll('[data-label]')].filter(e => {
  const label = getComputedStyle(e, '::before');
  if (label.content === 'none' || !e.checkVisibility()) return false;
  const box = e.getBoundingClientRect(), top = box.top + parseFloat(label.top), range = document.createRange();
  range.selectNodeContents(e);
  return [...range.getClientRects()].some(r => r.width && r.left < box.left + parseFloat(label.width) - 1
    && r.top < top + parseFloat(label.height) - 4 && r.bottom > top + 4);
}).map(e => e.textContent.slice(0, 60)).slice(0, 10)
"""
#: text whose contrast with what lies behind it is below that of WCAG 2.2, 1.4.3: 4.5, and 3 where it is large
FAINT = """
(() => {
  const part = c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const light = c => 0.2126 * part(c[0] / 255) + 0.7152 * part(c[1] / 255) + 0.0722 * part(c[2] / 255);
  const parts = text => { const c = text.match(/[\\d.]+/g).map(Number); return c.length < 4 ? [...c, 1] : c; };
  const canvas = matchMedia('(prefers-color-scheme: dark)').matches ? [18, 18, 18] : [255, 255, 255];
  const behind = e => {
    for (; e; e = e.parentElement) {
      const c = parts(getComputedStyle(e).backgroundColor);
      if (c[3] > 0) return c[3] === 1 ? c : null;
    }
    return canvas;
  };
  const found = new Set(), walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const e = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !e.checkVisibility() || e.closest('.unseen, .skip')) continue;
    const style = getComputedStyle(e), size = parseFloat(style.fontSize), ground = behind(e);
    const large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
    const two = ground === null ? [0, 1] : [light(parts(style.color)), light(ground)].sort((a, b) => b - a);
    const ratio = (two[0] + 0.05) / (two[1] + 0.05);
    if (ratio < (large ? 3 : 4.5)) found.add(`${e.tagName}.${e.className} ${ratio.toFixed(2)}`);
  }
  return [...found].slice(0, 10);
})()
"""
#: what a Tab can reach on a page as it is opened, and what the keys have reached since
REACHABLE = """
[...document.querySelectorAll('a[href], summary, [tabindex="0"]')].filter(e => e.checkVisibility()).length
"""
WATCH = """
(() => {
  window.reached = [];
  document.addEventListener('focusin', ({target: e}) => {
    const style = getComputedStyle(e);
    window.reached.push({what: e.outerHTML.slice(0, 80), first: !e.dataset.reached,
      outline: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0});
    e.dataset.reached = 'yes';
  });
  document.addEventListener('focusout', ({target: e}) => {  // it has been scrolled to by then
    const r = e.getBoundingClientRect();
    const seen = r.bottom > 0 && r.top < innerHeight && r.right > 0 && r.left < innerWidth;
    window.reached.at(-1).visible = seen || e.matches('.skip');  // which is hidden again by now
  });
  return true;
})()
"""
FOCUSED = """
(() => {
  const e = document.activeElement, style = getComputedStyle(e), r = e.getBoundingClientRect();
  return {tag: e.tagName, href: e.getAttribute('href'), name: e.getAttribute('aria-labelledby') || e.textContent.trim(),
          outline: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0,
          visible: r.bottom > 0 && r.top < innerHeight && r.right > 0};
})()
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    binary = chromium()
    if binary is None:
        assert not os.environ.get("CI"), "the page must be seen in a browser: install the package chromium"
        # at a desk without a browser the other tests still count; continuous integration fails above
        pytest.skip("no chromium on this machine: install the package chromium to look at the page")
    browser = Browser(binary, tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The example's pages, the index first, and where results exist the project's own index and papers."""
    root = EXAMPLE["build"](tmp_path_factory.mktemp("project"))
    papers = [read_results(read_case(root, paper)) for paper in ("toy2001", "bare2002")]
    found = [write_index(root, papers), *(write_paper(paper) for paper in papers)]
    own = find_root(Path(__file__)) / "results"
    return [*found, *sorted(own.glob("index.html")), *sorted(own.glob("*/index.html"))]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_page_is_quiet_and_fits(browser, pages, size, scheme):
    for page in pages:
        browser.open(page, size, scheme)
        assert browser.evaluate(OVERFLOW) == [], page
        browser.evaluate(OPEN_ALL)
        assert browser.evaluate(OVERFLOW) == [], page
        assert browser.evaluate(COVERED) == [], page
        assert browser.evaluate(FAINT) == [], page
        browser.wait("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        assert browser.troubles() == [], page


def test_a_page_in_trouble_is_noticed(browser, tmp_path):
    # The checks above can fail: a page with an error, a foreign address and a wide box trips each of them.
    page = tmp_path / "bad.html"
    page.write_text(
        '<img src="http://127.0.0.1:9/x.png"><p style="width:2000px; color:#999">wide</p><script>throw 1</script>'
    )
    browser.open(page, PHONE)
    troubles = "\n".join(browser.troubles())
    assert "exceptionThrown" in troubles
    assert "request: http://127.0.0.1:9/x.png" in troubles
    assert browser.evaluate(OVERFLOW)
    assert browser.evaluate(FAINT) == ["P. 2.85"]  # of #999999 on white: 1.05 / (0.3185 + 0.05)


def test_a_page_that_is_mailed_alone_is_whole(browser, pages, tmp_path):
    for page in pages:
        if page.parent.name == "results":
            continue
        alone = tmp_path / f"{page.parent.name}.html"
        alone.write_bytes(page.read_bytes())
        browser.open(alone, DESK)
        browser.wait("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        assert browser.troubles() == [], page
        assert browser.evaluate(DEAD_LINKS) == [], page
        assert alone.stat().st_size <= MOST_BYTES, page


def test_index_is_an_overview(browser, pages):
    for page in pages:
        if page.parent.name != "results":
            continue
        assert page.stat().st_size < 300_000
        browser.open(page, DESK)
        # a screen a paper, the overview and what it rests on
        screens = browser.evaluate("document.querySelectorAll('article').length") + 3
        assert browser.evaluate("document.documentElement.scrollHeight") < screens * DESK[1]


def test_printed_pages(browser, pages):
    for page in pages:
        browser.open(page, DESK)
        pdf = base64.b64decode(browser.call("Page.printToPDF", preferCSSPageSize=True)["data"])
        count = len(re.findall(rb"/Type\s*/Page[^s]", pdf))
        assert 1 <= count <= MOST_PRINTED.get(page.parent.name, 30), (page, count)
        # what is folded stays folded, no table loses its head, and none is wider than the sheet of 186 mm
        browser.call("Emulation.setDeviceMetricsOverride", width=703, height=1000, deviceScaleFactor=1, mobile=False)
        browser.call("Emulation.setEmulatedMedia", media="print", features=[])
        assert browser.evaluate("[...document.querySelectorAll('thead')].every(e => e.getClientRects().length > 0 || "
                                "!e.checkVisibility())")  # fmt: skip
        assert browser.evaluate("document.documentElement.scrollWidth") <= 703, page
        browser.call("Emulation.setEmulatedMedia", media="", features=[])


@pytest.mark.parametrize("kind", ["deuteranopia", "protanopia", "tritanopia", "achromatopsia"])
def test_verdicts_differ_without_colours(browser, pages, kind):
    # Each verdict has its word and a mark of its own: drawn under each vision, no two marks are the same picture.
    browser.call("Emulation.setEmulatedVisionDeficiency", type=kind)
    try:
        browser.open(pages[0], DESK)
        boxes = browser.evaluate(MARKS)
        shots = {}
        for verdict, (x, y) in boxes.items():
            clip = {"x": x, "y": y, "width": 16, "height": 16, "scale": 4}
            shots[verdict] = browser.call("Page.captureScreenshot", format="png", clip=clip)["data"]
    finally:
        browser.call("Emulation.setEmulatedVisionDeficiency", type="none")
    assert len(shots) == 5
    assert len(set(shots.values())) == 5


def test_keyboard_reaches_the_links(browser, pages):
    browser.open(pages[0], DESK)
    browser.press("Tab", 9)
    first = browser.evaluate(FOCUSED)
    assert first["href"] == "#main"
    assert first["visible"] and first["outline"]
    reached = []
    for _ in range(40):
        browser.press("Tab", 9)
        focused = browser.evaluate(FOCUSED)
        if focused["tag"] == "BODY":
            break
        assert focused["outline"], focused
        assert focused["visible"], focused
        reached.append(focused["href"])
    for href in ("verdicts.csv", "toy2001/index.html", "#toy2001", "toy2001/index.html#toy2001-claim-eq14"):
        assert href in reached


def test_keyboard_reaches_everything_on_every_page(browser, pages):
    for page in pages:
        browser.open(page, DESK)
        count = browser.evaluate(REACHABLE)
        browser.evaluate(WATCH)
        for _ in range(count):
            browser.press("Tab", 9)
        reached = browser.evaluate("document.activeElement.blur(), window.reached")
        assert len(reached) == count, page
        assert [one for one in reached if not (one["first"] and one["outline"] and one["visible"])] == [], page


def test_keyboard_opens_a_claim(browser, pages):
    browser.open(pages[1], DESK)
    browser.evaluate("document.querySelector('details.claim > summary').focus(), true")
    browser.press("Enter", 13, text="\r")
    browser.wait("document.querySelector('details.claim').open")


def test_a_link_opens_the_claim_it_leads_to(browser, pages):
    browser.open(pages[1], DESK)
    browser.evaluate("location.hash = 'toy2001-claim-eq14', true")
    browser.wait("document.getElementById('toy2001-claim-eq14').closest('details').open")
    shown = browser.evaluate("document.getElementById('toy2001-claim-eq14').innerText")
    assert "Farkas" in shown and "gainsay prove" in shown


def test_page_reads_without_scripts(browser, pages):
    browser.call("Emulation.setScriptExecutionDisabled", value=True)
    try:
        browser.open(pages[1], DESK)
    finally:
        browser.call("Emulation.setScriptExecutionDisabled", value=False)
    assert "is feasible." in browser.evaluate("document.body.innerText")
    assert browser.evaluate("document.scripts.length") == 0
    # mathematics is drawn by the browser itself: a fraction of a line high, wider than nothing
    assert browser.evaluate("[...document.querySelectorAll('math')].some(e => e.getBoundingClientRect().width > 20)")
