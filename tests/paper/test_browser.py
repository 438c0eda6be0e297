"""The page in a real browser: every image shows, nothing is cut off, and it prints.

The copy that is opened has a script appended that tells what the browser made of it.
"""

import json
import os
import re
import subprocess
from html import unescape
from shutil import which

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

BROWSER = next(filter(None, map(which, NAMES)), None)

pytestmark = [
    pytest.mark.slow,  # a browser draws the page
    pytest.mark.skipif(
        BROWSER is None, reason=f"needs a browser that runs headless: none of {', '.join(NAMES)}"
    ),
]

TELL = """<script>addEventListener("load", () => parent.postMessage({
  width: innerWidth, needed: document.documentElement.scrollWidth,
  blank: [...document.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.alt),
  images: document.images.length,
  beyond: [...document.querySelectorAll("main > *, figure, .statements td")]
    .filter(e => e.getBoundingClientRect().right > innerWidth + 1).length,
  small: [...document.querySelectorAll("td, p, figcaption")]
    .filter(e => parseFloat(getComputedStyle(e).fontSize) < 12).length,
}, "*"));</script></body>"""

# A browser window has a least width; a frame inside has none.
FRAME = """<!DOCTYPE html><body style="margin:0"><iframe src="page.html" width="{width}"
height="3000" style="border:0"></iframe><pre></pre><script>addEventListener("message", event =>
document.querySelector("pre").textContent = JSON.stringify(event.data));</script></body>"""


def browse(folder, *options):
    """Run the browser, without windows, network or a profile of the user's."""
    always = ["--headless", "--disable-gpu", "--virtual-time-budget=20000", "--hide-scrollbars"]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        always.append("--no-sandbox")
    profile = f"--user-data-dir={folder / 'profile'}"
    return subprocess.run(
        [BROWSER, *always, profile, *options],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    ).stdout


@pytest.mark.parametrize("width", [1280, 390], ids=["desktop", "phone"])
def test_it_is_readable_on(reproduced, tmp_path, width):
    page = reproduced.html.replace("</body>", TELL)
    (tmp_path / "page.html").write_text(page, "utf-8")
    frame = tmp_path / "frame.html"
    frame.write_text(FRAME.format(width=width), "utf-8")
    shown = browse(tmp_path, f"--window-size={max(width, 500)},3000", "--dump-dom", frame.as_uri())
    told = json.loads(unescape(re.search(r"<pre>(.*?)</pre>", shown, re.DOTALL).group(1)))
    assert told["width"] == width
    assert told["needed"] <= width
    assert told["images"] == reproduced.html.count("<img")
    assert told["blank"] == []
    assert told["beyond"] == 0
    assert told["small"] == 0


def test_it_prints(reproduced, tmp_path):
    pdf = tmp_path / "page.pdf"
    browse(tmp_path, f"--print-to-pdf={pdf}", (reproduced.folder / "index.html").as_uri())
    assert pdf.read_bytes().startswith(b"%PDF")
    # Vectors, not a picture of them: an empty print is a few kilobytes.
    assert pdf.stat().st_size > 1e5
