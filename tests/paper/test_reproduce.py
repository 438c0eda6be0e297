import json
import re
from base64 import b64decode
from html import escape
from html.parser import HTMLParser
from importlib import import_module
from types import SimpleNamespace
from typing import get_args

import pytest
from typer.testing import CliRunner

from tests.browser import needs_browser
from tractive_sam import plot
from tractive_sam.cli import app
from tractive_sam.cli.show import Format
from tractive_sam.paper import CHAPTERS, FULL, Chapter, Picture, Statement, Verdict, reproduce
from tractive_sam.paper.page import text
from tractive_sam.store import open_history

pytestmark = pytest.mark.slow  # every figure of the paper

FIGURES = ("5", "6", "7", "8", "15", "16", "17", "18")
"""Those that the text at hand describes."""

# Does not depend on the mesh: theory, symmetry, or the law that is solved.
SURE = (
    "P = 0.4705 N",
    "sliding zone is at the back",
    "more than Kalker",
    "Q_x(β = 0°)/2",
    "Q_y is zero for β = 0° and 90°",
    "not symmetric",
    "higher for β = 0°",
    "eq. (19)",
)


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory):
    """Reproduce the paper at its reduced size; return folder, page and printed text.

    Of figures that are alike for each angle of the friction axes, the picture of one is drawn.
    """
    folder = tmp_path_factory.mktemp("paper") / "reproduced"
    arguments = ["reproduce", "-o", str(folder), "--reduced", "--format", "svg"]
    draw, drawn = Picture.svg.func, {}

    def draw_one_angle(picture):
        kind = re.sub(r"-(0|45|90)$", "", picture.name)
        if kind not in drawn:
            drawn[kind] = draw(picture)
        return drawn[kind]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Picture, "svg", property(draw_one_angle))
        result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    html = (folder / "index.html").read_text("utf-8")
    return SimpleNamespace(folder=folder, html=html, printed=result.stdout)


class Page(HTMLParser):
    """Opened elements, and the images."""

    EMPTY = frozenset({"meta", "img", "br", "input"})

    def __init__(self, html):
        super().__init__()
        self.open, self.images, self.addresses = [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag not in self.EMPTY:
            self.open.append(tag)
        if tag == "img":
            self.images.append(attributes)
        self.addresses += [attributes[key] for key in ("src", "href") if key in attributes]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def statements(reproduced):
    return json.loads((reproduced.folder / "statements.json").read_text("utf-8"))


def test_command_prints_the_page(reproduced):
    assert reproduced.printed.strip() == str(reproduced.folder / "index.html")


def test_page_is_well_formed_and_needs_nothing_else(reproduced):
    page = Page(reproduced.html)
    assert not page.open
    own = ("data:image/svg", "#chapter-", "#contents")
    foreign = [at for at in page.addresses if not at.startswith(own)]
    assert foreign == ["https://doi.org/10.1016/j.ijmecsci.2025.110195"]
    assert not re.search(r"@import|url\(|<script|<link", reproduced.html)


def test_every_figure_is_there_and_is_a_file(reproduced):
    images = Page(reproduced.html).images
    files = sorted((reproduced.folder / "figures").iterdir())
    assert len(images) == len(files)
    embedded = {b64decode(image["src"].partition(",")[2]) for image in images}
    assert embedded == {file.read_bytes() for file in files}
    captions = " ".join(image["alt"] for image in images)
    for number in FIGURES:
        assert re.search(rf"Fig\. {number}\b", captions), number


def test_statements_are_on_the_page(reproduced):
    reported = statements(reproduced)
    assert {one["verdict"] for one in reported} <= set(Verdict)
    for one in reported:
        assert text(one["paper"]) in reproduced.html
        assert text(one["ours"]) in reproduced.html
    assert "nan" not in json.dumps(reported)
    assert "inf " not in json.dumps(reported)


@pytest.mark.parametrize("part", SURE)
def test_what_no_mesh_changes_agrees(reproduced, part):
    (found,) = (one for one in statements(reproduced) if part in one["paper"])
    assert found["verdict"] == Verdict.AGREES, found["ours"]


def test_reduced_size_is_reported(reproduced):
    assert "A reduced size" in reproduced.html
    assert FULL.name not in reproduced.html


def test_results_are_kept(reproduced):
    names = sorted(path.name for path in (reproduced.folder / "results").iterdir())
    turned = [f"twin-discs-{angle}.h5" for angle in (0, 45, 90)]
    assert names == sorted([*turned, "twin-discs-isotropic.h5"])
    for name in names:
        assert open_history(reproduced.folder / "results" / name).finished


def test_verdicts():
    assert Verdict.from_conditions(True, True) is Verdict.AGREES
    assert Verdict.from_conditions(True, False) is Verdict.PARTLY
    assert Verdict.from_conditions(False) is Verdict.DIFFERS


def test_plain_text_is_escaped_and_indices_lowered():
    assert text("Q_x < -0.5 µP, Figs. 9-14") == "Q<sub>x</sub> &lt; −0.5 µP, Figs. 9-14"


def test_unknown_format(tmp_path):
    with pytest.raises(ValueError, match=r"format.*png"):
        reproduce(tmp_path, format="gif")


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "taken").write_text("")
    result = CliRunner().invoke(app, ["reproduce", "-o", str(tmp_path / "taken")])
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr


def one_figure(work):
    yield Statement("Fig. 0", "a", "b", Verdict.OPEN)
    yield Picture("fig-00", lambda: plot.creep_force_curve({"one": ([0.5], [0.8])}), "Fig. 0.")


def interrupted(work):
    yield from one_figure(work)
    raise KeyboardInterrupt


def test_an_earlier_run_is_replaced(tmp_path, monkeypatch):
    module = import_module("tractive_sam.paper.reproduction")
    monkeypatch.setattr(module, "CHAPTERS", (Chapter("One", "Fig. 0", one_figure),))
    reported = []
    for format in ("png", "pdf"):
        page = reproduce(tmp_path, format=format, progress=lambda *line: reported.append(line))
        assert [file.name for file in (tmp_path / "figures").iterdir()] == [f"fig-00.{format}"]
    assert reported == [(0, "figure fig-00")] * 2
    assert escape(FULL.name) in page.read_text("utf-8")
    monkeypatch.setattr(module, "CHAPTERS", (Chapter("One", "Fig. 0", interrupted),))
    with pytest.raises(KeyboardInterrupt):
        reproduce(tmp_path)
    assert not page.exists()


def test_a_figure_that_fails_is_omitted(tmp_path, monkeypatch):
    def chapter(work):
        yield Picture("fig-fails", lambda: 1 / 0, "Fig. 1.")
        yield from one_figure(work)

    module = import_module("tractive_sam.paper.reproduction")
    monkeypatch.setattr(module, "CHAPTERS", (Chapter("One", "Fig. 0", chapter),))
    with pytest.warns(UserWarning, match="fig-fails is omitted"):
        page = reproduce(tmp_path)
    assert [file.stem for file in (tmp_path / "figures").iterdir()] == ["fig-00"]
    assert "fig-fails" not in page.read_text("utf-8")


def test_chapters_and_formats():
    assert len(CHAPTERS) == 5
    assert [*get_args(Format)] == ["png", "pdf", "svg"]
    assert Statement("Fig. 1", "a", "b", Verdict.OPEN).verdict == "cannot be decided"


MEASURES = """({
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
})"""


@needs_browser
@pytest.mark.parametrize("width", [1280, 390], ids=["desktop", "phone"])
def test_it_is_readable_on(reproduced, browser, width):
    browser.open((reproduced.folder / "index.html").as_uri(), width)
    found = browser.run(MEASURES)
    assert found["width"] == width
    assert found["needed"] <= width
    assert found["images"] == reproduced.html.count("<img")
    assert found["blank"] == []
    assert found["beyond"] == 0
    assert found["small"] == 0
    assert found["narrow"] == []  # text of figures, made with 13 pixels, has 10 and more
    assert found["contents"] == 0


@needs_browser
def test_it_prints(reproduced, browser):
    browser.open((reproduced.folder / "index.html").as_uri(), 1280)
    pdf = browser.print_pdf()
    assert pdf.startswith(b"%PDF")
    # Vectors, not a picture of them: an empty print is a few kilobytes.
    assert len(pdf) > 1e5
