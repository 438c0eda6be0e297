"""Symbols and units as HTML."""

import re

from tractive_sam.markup import Html, as_html, fill

_SIGNS = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "varepsilon": "ε",
    "theta": "θ",
    "lambda": "λ",
    "mu": "µ",
    "xi": "ξ",
    "sigma": "σ",
    "tau": "τ",
    "phi": "φ",
    "varphi": "φ",
    "omega": "ω",
    "Delta": "Δ",
    "Phi": "Φ",
    "Omega": "Ω",
}


def symbol(math: str) -> Html:
    """Math text of a symbol as HTML; empty where it is more than letters, signs and indices."""
    flat = re.sub(r"\\(?:mathrm|text)\{([^{}]*)\}", r"\1", math)
    flat = re.sub(r"\\([A-Za-z]+)\s*", lambda found: _SIGNS.get(found[1], found[0]), flat)
    flat = as_html(flat.replace(r"\,", "\u2009"))
    for sign, tag in (("_", "sub"), (r"\^", "sup")):
        flat = re.sub(rf"{sign}(?:\{{([^{{}}]*)\}}|(\w+|\S))", rf"<{tag}>\1\2</{tag}>", flat)
    return Html("" if re.search(r"[\\{}$]", flat) else flat)


def unit(one: str) -> str:
    """A unit with its powers raised; empty of what has none."""
    raised = re.sub(r"(?<=[a-z])([23])(?!\d)", lambda found: "²³"[int(found[1]) - 2], one)
    return "" if one == "1" else raised


def with_unit(content: Html, one: str) -> Html:
    """HTML followed by a unit in brackets, if there is one."""
    return fill("$content ($unit)", content=content, unit=unit(one)) if unit(one) else content
