"""Words that obscure names and texts, counted for each part of the project; the numbers only fall.

A name or a sentence is right when a tribologist who has never seen the package, and whose first
language need not be English, understands it at first reading: "report", not "tell".
"""

import ast
import json
import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

NAMES = re.compile(
    r"""accurately | alone | anew | asked | asks | beside | came | credited | doubt(s|ful) | drawn
    | eased | followed | former | heaps | heed | held | snake | spell | sparing | stepped | tell
    | telling | tells | told | travelled | unturned | watched | ways? | whats""",
    re.VERBOSE,
)
"""Words of identifiers that say neither what a function does nor what a value is."""

PHRASES = re.compile(
    r"""\b(
    told | tells? | telling | asks?\ for | asked\ for | is\ asked | are\ asked | the\ very
    | (of|by)\ (one's|its|their|his|a\ user's)\ own | what\ there\ is\ to | as\ of | of\ which
    | go(es)?\ on | gone\ on | go(es)?\ by | comes?\ round | answers?\ to | gives?\ way
    | mend(s|ed)? | anew | likewise | (no|any)body | in\ one\ way | on\ the\ way
    )\b""",
    re.IGNORECASE | re.VERBOSE,
)
"""Phrases of docstrings, comments, messages and pages."""

LIMITS = {  # names, phrases
    "tractive_sam/**/*.py": (1, 0),  # `tell` of the file that HDF5 writes to
    "tests/**/*.py": (35, 0),
    "benchmarks/**/*.py": (0, 0),
    "benchmarks/*.md": (0, 0),
    "docs/**/*.py": (0, 0),
    "docs/**/*.md": (0, 0),
    "notebooks/*.ipynb": (0, 0),
    "README.md": (0, 0),
}


COMMENT = re.compile(r"(?:^|\s)# .*", re.MULTILINE)


def read_python(source):
    """Return the names that a module gives, and its prose: comments and strings with a space."""
    names, prose = [], []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.arg(arg=name):
                names.append(name)
            case ast.Name(id=name, ctx=ast.Store()):
                names.append(name)
            case ast.Constant(value=str(text)) if " " in text:
                prose.append(text)
    return names, prose + COMMENT.findall(source)


def read_notebook(source):
    """Return the same for a notebook; lines of its code that are not Python are left out."""
    code, prose = [], []
    for cell in json.loads(source)["cells"]:
        if cell["cell_type"] == "markdown":
            prose.append("".join(cell["source"]))
        else:
            code += [line.rstrip() for line in cell["source"] if not line.startswith(("%", "!"))]
    names, prose_of_code = read_python("\n".join(code))
    return names, prose + prose_of_code


def read_page(source):
    return [], [re.sub(r"```.*?```", " ", source, flags=re.DOTALL)]


READERS = {".py": read_python, ".md": read_page, ".ipynb": read_notebook}


def find_texts(pattern):
    """Yield the files of a part of the project, without those that a build makes and this one."""
    for file in sorted(ROOT.glob(pattern)):
        folders = file.relative_to(ROOT).parts[:-1]
        if file != Path(__file__) and not any(name.startswith(("_", ".")) for name in folders):
            yield file


def count_words(pattern):
    """Return how often names and prose of a part of the project use each of the words."""
    names, phrases = Counter(), Counter()
    for file in find_texts(pattern):
        found, prose = READERS[file.suffix](file.read_text("utf-8"))
        words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", " ".join([*found, file.stem]))
        for word in map(str.lower, words):
            names[word] += NAMES.fullmatch(word) is not None
        phrases.update(match[0].lower() for text in prose for match in PHRASES.finditer(text))
    return +names, phrases


@pytest.mark.parametrize("part", LIMITS)
def test_words_that_obscure_do_not_spread(part):
    names, phrases = count_words(part)
    limit = LIMITS[part]
    assert names.total() <= limit[0], f"names of {part}: {names}"
    assert phrases.total() <= limit[1], f"prose of {part}: {phrases}"
