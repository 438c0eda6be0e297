"""Duty cycles and wear laws: what each block wore, and in which regime."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from tractive_sam import mechanics  # its laws load the compiler when first used
from tractive_sam.plot.conditions import Need
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.profiles import across
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import (
    GREY,
    MICRON,
    WIDTH,
    along,
    colours,
    set_title,
    told,
    told_of,
)
from tractive_sam.results import PARTS, SHARE, History, State

if TYPE_CHECKING:
    from tractive_sam.contact import Laws
    from tractive_sam.mechanics import WearLaw

PER_DEPTH = 1e3
"""µg/(m mm²) of a body of 1 kg/m³ that wears as deep as it is rolled."""

ENTRIES = 12
"""Names of blocks beside a figure, one below the other."""

DECADES = 4.0
"""Decades of frictional work that a map of regimes shows below its largest."""

_OF_BLOCKS = (PARTS.name, SHARE.name)

_WORN = Need(lambda history: history[PARTS.name].any(), "wear, and there is none")


@history_figure("worn-by-block", columns=_OF_BLOCKS, needs=[_WORN], cure="[[duty]]")
def worn_by_block(history: History) -> Figure:
    """Wear depth across the track at the end, as the blocks of a duty cycle made it.

    Raises
    ------
    ValueError
        If there are no blocks, or nothing is worn.

    Examples
    --------
    >>> spectrum = discs.replace(duty=({"revolutions": 1}, {"revolutions": 1, "shift_y": 0.2}))
    >>> plot.worn_by_block(ts.roll(spectrum))
    <Figure size ...>
    """
    figure, axes = across(history, "wear of both bodies by block")
    axes.set_prop_cycle(color=colours(len(history.block_names)))
    y, depth = history.y / Scale.of_history(history).across, np.zeros(len(history.y))
    parts = history[PARTS.name][-1].sum(axis=1)
    for name, part in zip(history.block_names, parts, strict=True):
        below = depth + MICRON * part
        axes.fill_between(y, depth, below, label=name, alpha=0.8, linewidth=0.4)
        depth = below
    axes.plot(y, depth, color="black", linewidth=0.8)
    axes.invert_yaxis()
    axes.set(xlim=(y.min(), y.max()), ylabel=r"wear depth $w$ ($\mathrm{\mu m}$)")
    _legend(figure)
    return figure


@history_figure("block-shares", columns=_OF_BLOCKS, needs=[_WORN], cure="[[duty]]")
def block_shares(history: History) -> Figure:
    """Share of each block of a duty cycle in the worn section, over the revolutions.

    Raises
    ------
    ValueError
        If there are no blocks, or nothing is worn.

    Examples
    --------
    >>> spectrum = discs.replace(duty=({"revolutions": 1}, {"revolutions": 1, "shift_y": 0.2}))
    >>> plot.block_shares(ts.roll(spectrum))
    <Figure size ...>
    """
    figure = Figure(figsize=(1.25 * WIDTH, 0.66 * WIDTH))
    axes = figure.add_subplot()
    worn = history["block_share"].sum(axis=1) > 0.0
    places, shares = history[history.coordinate.name][worn], history["block_share"][worn]
    names = history.block_names
    along(axes, history)
    axes.set_prop_cycle(color=colours(len(names)))
    axes.stackplot(places, 100.0 * shares.T, labels=names, alpha=0.8)
    axes.set(ylim=(0.0, 100.0), ylabel="share of the worn section (%)")
    set_title(figure, told_of(history, "wear of both bodies by block"))
    _legend(figure)
    return figure


def _by_laws(history: History) -> bool:
    """Whether the scene's laws of wear differ between bodies or blocks, or have regimes."""
    scene = history.scene
    if "wear" in history.law_records or not scene.has("wear") or not history["wear_profile"].any():
        return False
    return bool(history.block_names) or not scene.has("wear.together")


@history_figure("wear-regimes", shown=_by_laws)
def wear_regimes(source: History | State, laws: "Laws | None" = None) -> Figure:
    """Rate of wear of the elements over their frictional work, T-gamma/A.

    Of a history the last stored contact, of a duty cycle those of all blocks. A dot is an element
    that wears, at its own work; a line the law, where it has regimes by work.

    Parameters
    ----------
    source : History or State
        What was solved.
    laws : Laws, optional
        What it was rolled with, where those are not the scene's.

    Raises
    ------
    ValueError
        If nothing wears.

    Examples
    --------
    >>> contact = ts.roll(discs.with_set(["wear.law=usfd"])).state(2)
    >>> plot.wear_regimes(contact)
    <Figure size ...>
    """
    figure = Figure(figsize=(1.25 * WIDTH, 0.8 * WIDTH))
    axes = figure.add_subplot()
    contacts = _contacts(source)
    axes.set_prop_cycle(color=colours(2 * len(contacts)))
    most = max(float(_work(one).max()) for one in contacts.values())
    drawn = [_dots(axes, name, one, laws, most) for name, one in contacts.items()]
    if not any(drawn):
        raise ValueError("nothing to draw: no element wears")
    axes.set(xscale="log", yscale="log", xlim=(most * 10.0**-DECADES, 2.0 * most))
    _laws_of(axes, next(iter(contacts.values())), laws, most)
    axes.set_xlabel(r"frictional work $T\gamma/A$ (N/mm$^2$)")
    axes.set_ylabel(r"wear rate ($\mathrm{\mu g}$/(m mm$^2$))")
    scene = source.scene
    set_title(figure, told(scene.title, "wear of each body over the work of each element"))
    _legend(figure)
    return figure


def _legend(figure: Figure) -> None:
    """Name the blocks beside the axes, in as many columns as they need."""
    names = sum(len(axes.get_legend_handles_labels()[1]) for axes in figure.axes)
    columns = -(-names // ENTRIES)
    width, height = figure.get_size_inches()
    legend = figure.legend(loc="outside right center", ncols=columns, columnspacing=1.0)
    if columns > 1:  # of room of their own
        own = legend.get_window_extent().width / figure.dpi
        figure.set_size_inches(width + own * (1.0 - 1.0 / columns), height)


def _contacts(source: History | State) -> dict[str, State]:
    if isinstance(source, State):
        return {"": source}
    blocks = {name: source.block(k) for k, name in enumerate(source.block_names)}
    return {name: one.state() for name, one in (blocks or {"": source}).items()}


def _wear_law(contact: State, laws: "Laws | None", *, warm: bool) -> "WearLaw | None":
    """The law of wear, as it is in the contact where that is warm, or as it is without heat."""
    # Loads compilers, which no other figure needs.
    from tractive_sam.contact import Laws, Model, wear_law_in  # noqa: PLC0415

    laws = laws or Laws.of_contact(contact, ("wear",))
    model = Model(contact.scene, grid=contact.grid, laws=laws)
    return wear_law_in(model, contact) if warm else model.wear_law


def _of_bodies(contact: State, laws: "Laws | None") -> dict[str, np.ndarray]:
    """Wear rate of the elements of each body, µg/(m mm²)."""
    law = _wear_law(contact, laws, warm=True)
    fields = contact.pressure, contact.traction, contact.slip
    if law is None or not contact.touching.any():
        return {}
    if isinstance(law, mechanics.EachBody):
        own = {body: getattr(law, body) for body in "AB"}
        rates = {body: one.rate(*fields) for body, one in own.items() if one is not None}
    else:
        share, of_bodies = contact.scene.wear_share, law.shares(*fields)
        if of_bodies is not None:
            share = dict(zip("AB", of_bodies, strict=True))
        rates = {body: share[body] * law.rate(*fields) for body in "AB"}
    return {
        body: PER_DEPTH * getattr(contact.scene.body, body).density * rate
        for body, rate in rates.items()
    }


def _work(contact: State) -> np.ndarray:
    """Frictional work of the elements over their area, N/mm²."""
    return np.maximum(-(contact.traction * contact.slip).sum(axis=0), 0.0)


def _dots(axes: Axes, name: str, contact: State, laws: "Laws | None", most: float) -> bool:
    """Draw the elements of a contact, those with hardly any work aside; whether there are any."""
    work, rates = _work(contact), _of_bodies(contact, laws)
    alike = len(rates) == 2 and np.allclose(rates["A"], rates["B"], rtol=1e-9)
    drawn = False
    for body, marker in (("A", "o"), ("B", "^")):
        rate = rates.get(body, np.zeros_like(work))
        wears = (rate > 0.0) & (work > most * 10.0**-DECADES)
        if wears.any() and not (alike and body == "B"):
            bodies = "A and B" if alike else body
            named = ", ".join(filter(None, (name, bodies)))
            axes.plot(work[wears], rate[wears], marker, markersize=3, alpha=0.6, label=named)
            drawn = True
    return drawn


def _laws_of(axes: Axes, contact: State, laws: "Laws | None", most: float) -> None:
    """Draw the regimes of the bodies' laws by work, and where they begin."""
    law, wear = _wear_law(contact, laws, warm=False), contact.scene.wear
    name = "law, without heat" if wear is not None and wear.temperature else "law"
    seen: list[object] = []
    for body in "AB":
        regimes = getattr(getattr(law, body, None), "regimes", None)
        if regimes is None or getattr(getattr(law, body), "element_area", None) or regimes in seen:
            continue
        seen.append(regimes)
        work = np.geomspace(most * 10.0**-DECADES, 2.0 * most, 400)
        axes.plot(work, regimes(work)[0], color=GREY, linewidth=1.0, zorder=0, label=name)
        for start in regimes.starts[1:]:
            if start < 2.0 * most:
                axes.axvline(start, color=GREY, linewidth=0.6, linestyle=":", zorder=0)
