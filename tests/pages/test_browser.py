"""The page in a browser, from its file: all is drawn, keys move it, nothing is requested."""

import pytest

import tractive_sam as ts
from tests.browser import needs_browser
from tests.pages.test_report import SMALL

pytestmark = [pytest.mark.slow, needs_browser]  # a browser draws the page

ROUND = ("grid.elements=[21, 21]", "grid.half_length=[4.08, 4.08]")
WORN = ("wear.coefficient=1e-4", "wear.revolutions=10", "wear.save=[0, 10]")

SCENES = {
    "discs": lambda: ts.Scene.builtin("twin-discs").with_set(SMALL),
    "one record": lambda: ts.Scene.builtin("spheres").with_set(ROUND),
    "frictionless": lambda: ts.Scene.builtin("spheres").replace(friction=None, creepage={}),
    "hot": lambda: ts.Scene.builtin("hot-discs"),
    "hot line": lambda: ts.Scene.builtin("cylinders").replace(
        **{"creepage.speed": 1e4, "heat": {"bulk": 20.0}, "friction.strength": 100.0}
    ),
    "shifts": lambda: ts.Scene.builtin("fretting").with_set(
        ["grid.elements=[21, 21]", "transient.distance=[0, 1]", "transient.load.force_x=[0, 45]"]
    ),
    "line": lambda: ts.Scene.builtin("cylinders").with_set([*WORN, 'subsurface.planes=["y=0"]']),
}

# Charts are drawn as they come into view: all of them, in a window higher than the page.
DRAWN = """new Promise(done => {
  const charts = [...document.querySelectorAll(".chart")].filter(e => e.checkVisibility());
  const drawn = e => e.querySelector(".main-svg"), end = Date.now() + 60000;
  const wait = () => charts.every(drawn) || Date.now() > end ? done({
    charts: charts.length,
    undrawn: charts.filter(e => !drawn(e)).map(e => e.getAttribute("aria-label")),
    empty: charts.filter(e => !e.querySelector(
      "path.js-line, .heatmaplayer image, .contourlayer path, .scatterlayer .point"
    )).map(e => e.getAttribute("aria-label")),
    needed: document.documentElement.scrollWidth,
    unnamed: [...document.querySelectorAll("input, select")].filter(e => e.checkVisibility())
      .filter(e => !(e.labels && e.labels.length) && !e.getAttribute("aria-label")).length,
    small: [...document.querySelectorAll("p, td, th, label, option, small, .chart text")]
      .filter(e => e.checkVisibility())
      .filter(e => parseFloat(getComputedStyle(e).fontSize) < 11).length,
  }) : setTimeout(wait, 50);
  wait();
})"""


@pytest.fixture(scope="module", params=SCENES)
def page(request, tmp_path_factory):
    history = ts.roll(SCENES[request.param]())
    return ts.report(history, tmp_path_factory.mktemp("page") / "page.html")


@pytest.mark.parametrize("width", [1440, 390], ids=["desktop", "phone"])
def test_everything_is_plotted(page, browser, width):
    browser.open(page.as_uri(), width, height=12000)
    reported = browser.run(DRAWN)
    assert browser.errors == []  # nothing that the page does is against its policy
    assert reported["charts"] >= 2
    assert reported["undrawn"] == []
    assert reported["empty"] == []
    assert reported["needed"] <= width
    assert reported["unnamed"] == 0
    assert reported["small"] == 0
    local = ("file:", "data:", "blob:")
    assert [one for one in browser.requests if not one.startswith(local)] == []


def test_keys_move_the_revolutions(browser, tmp_path):
    history = ts.roll(ts.Scene.builtin("twin-discs").with_set(SMALL))
    page = ts.report(history, tmp_path / "page.html")
    shown = "[document.querySelector('#rows td:nth-child(2)').textContent,"
    shown += " document.querySelector('#at').getAttribute('aria-valuetext')]"
    figures = "document.querySelector('.chart.map').data[0].z[15][5]"
    browser.open(page.as_uri(), 1440)
    browser.run(DRAWN.replace(".chart", ".chart.map"))
    for _ in range(20):  # to the slider, by the tab key alone
        if browser.run("document.activeElement.id") == "at":
            break
        browser.press("Tab", 9)
    assert browser.run("document.activeElement.id") == "at"
    assert browser.run(shown) == ["20", "N = 20"]
    before = browser.run(figures)
    browser.press("ArrowLeft", 37)
    moved = "new Promise(done => requestAnimationFrame(() => setTimeout(() => done(%s), 500)))"
    assert browser.run(moved % shown) == ["5", "N = 5"]
    assert browser.run(figures) != before
