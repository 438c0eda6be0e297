"""The page in a real browser: every image shows, nothing is cut off, and it prints.

The copy that is opened has a script appended that tells what the browser made of it.
"""

import pytest

from tests.browser import browse, needs_browser, told_by

pytestmark = [pytest.mark.slow, needs_browser]  # a browser draws the page

TELL = """addEventListener("load", () => parent.postMessage({
  width: innerWidth, needed: document.documentElement.scrollWidth,
  blank: [...document.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.alt),
  images: document.images.length,
  beyond: [...document.querySelectorAll("main > *, figure, .statements td")]
    .filter(e => e.getBoundingClientRect().right > innerWidth + 1).length,
  narrow: [...document.querySelectorAll("figure img")]
    .filter(e => e.clientWidth < 0.75 * Math.min(e.naturalWidth, innerWidth)).map(e => e.alt),
  contents: [...document.querySelectorAll("#contents a, .up")]
    .filter(e => !document.querySelector(e.getAttribute("href"))).length,
  small: [...document.querySelectorAll("td, p, figcaption")]
    .filter(e => parseFloat(getComputedStyle(e).fontSize) < 12).length,
}, "*"));"""


@pytest.mark.parametrize("width", [1280, 390], ids=["desktop", "phone"])
def test_it_is_readable_on(reproduced, tmp_path, width):
    told = told_by(reproduced.html, TELL, tmp_path, width)
    assert told["width"] == width
    assert told["needed"] <= width
    assert told["images"] == reproduced.html.count("<img")
    assert told["blank"] == []
    assert told["beyond"] == 0
    assert told["small"] == 0
    assert told["narrow"] == []  # text of figures, made with 13 pixels, has 10 and more
    assert told["contents"] == 0


def test_it_prints(reproduced, tmp_path):
    pdf = tmp_path / "page.pdf"
    browse(tmp_path, f"--print-to-pdf={pdf}", (reproduced.folder / "index.html").as_uri())
    assert pdf.read_bytes().startswith(b"%PDF")
    # Vectors, not a picture of them: an empty print is a few kilobytes.
    assert pdf.stat().st_size > 1e5
