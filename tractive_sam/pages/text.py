"""Symbols, units and texts as HTML."""

import re
from html import escape

from tractive_sam.plain import plain
from tractive_sam.results import Quantity

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


def told(text: str) -> str:
    """Plain text, as it is, for HTML."""
    return escape(plain(text, None))


def symbol(math: str) -> str:
    """Math text of a symbol as HTML; empty where it is more than letters, signs and indices."""
    flat = re.sub(r"\\(?:mathrm|text)\{([^{}]*)\}", r"\1", math)
    flat = re.sub(r"\\([A-Za-z]+)\s*", lambda found: _SIGNS.get(found[1], found[0]), flat)
    flat = escape(flat.replace(r"\,", "\u2009"), quote=False)
    for sign, tag in (("_", "sub"), (r"\^", "sup")):
        flat = re.sub(rf"{sign}(?:\{{([^{{}}]*)\}}|(\w+|\S))", rf"<{tag}>\1\2</{tag}>", flat)
    return "" if re.search(r"[\\{}$]", flat) else flat


def unit(one: str) -> str:
    """A unit with its powers raised; empty of what has none."""
    raised = re.sub(r"(?<=[a-z])([23])(?!\d)", lambda found: "²³"[int(found[1]) - 2], one)
    return "" if one == "1" else raised


def label(one: Quantity) -> str:
    """Symbol, or description, and unit of a quantity, for an axis."""
    name = symbol(one.symbol) or told(one.label or one.long_name)
    return f"{name} ({unit(one.unit)})" if unit(one.unit) else name
