"""Duty cycles and wear laws: the wear of each block, and its regime."""

import numpy as np
from matplotlib.axes import Axes

import tractive_sam as ts
from tractive_sam import mechanics  # its laws load the compiler when first used
from tractive_sam.plot.contact_view import Need
from tractive_sam.plot.fields import lateral_axes
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.style import (
    LOOK,
    MICRON,
    Scale,
    format_title,
    history_title,
    label_course,
    line_colours,
    new_axes,
)
from tractive_sam.results import BODIES, PARTS, SHARE, History, State

_BLOCK_COLUMNS = (PARTS.name, SHARE.name)

_WORN = Need(lambda history: history[PARTS.name].any(), "wear, and there is none")


@history_figure("worn-by-block", columns=_BLOCK_COLUMNS, needs=[_WORN], cure="[[duty]]")
def worn_by_block(history: History) -> Figure:
    """Wear depth across the track at the end, divided among the blocks of a duty cycle.

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
    figure, axes = lateral_axes(history, "wear of both bodies by block")
    axes.set_prop_cycle(color=line_colours(len(history.block_names)))
    y, depth = history.y / Scale.from_history(history).across, np.zeros(len(history.y))
    parts = history[PARTS.name][-1].sum(axis=1)
    for name, part in zip(history.block_names, parts, strict=True):
        below = depth + MICRON * part
        axes.fill_between(y, depth, below, label=name, alpha=0.8, linewidth=0.4)
        depth = below
    axes.plot(y, depth, color="black", linewidth=0.8)
    axes.invert_yaxis()
    axes.set(xlim=(y.min(), y.max()), ylabel=r"wear depth $w$ ($\mathrm{\mu m}$)")
    _add_legend(figure)
    return figure


@history_figure("block-shares", columns=_BLOCK_COLUMNS, needs=[_WORN], cure="[[duty]]")
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
    figure, axes = new_axes(
        title=history_title(history, "wear of both bodies by block"), width=1.25
    )
    worn = history["block_share"].sum(axis=1) > 0.0
    places, shares = history[history.coordinate.name][worn], history["block_share"][worn]
    label_course(axes, history)
    axes.set_prop_cycle(color=line_colours(len(history.block_names)))
    axes.stackplot(places, 100.0 * shares.T, labels=history.block_names, alpha=0.8)
    axes.set(ylim=(0.0, 100.0), ylabel="share of the worn section (%)")
    _add_legend(figure)
    return figure


def _has_wear_regimes(history: History) -> bool:
    """Return whether stored wear comes from separate laws of the bodies, or from several blocks."""
    scene = history.scene
    if "wear" in history.law_records or not scene.has("wear") or not len(history.saved):
        return False
    if not history["wear_profile"].any():
        return False
    return bool(history.block_names) or not scene.has("wear.together")


@history_figure("wear-regimes", shown=_has_wear_regimes)
def wear_regimes(source: History | State, laws: "ts.Laws | None" = None) -> Figure:
    """Rate of wear of the elements over their frictional work, T-gamma/A.

    A history shows its last stored contact, a duty cycle the last one of each block. A dot is an
    element that wears; a line is the law, if it has regimes of work.

    Parameters
    ----------
    source : History or State
        History or contact with wear.
    laws : Laws, optional
        Laws of the computation, if they differ from the scene's.

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
    title = format_title(source.scene.title, "wear of each body over the work of each element")
    figure, axes = new_axes(1.25, 0.8, title)
    contacts = _last_contacts(source)
    axes.set_prop_cycle(color=line_colours(2 * len(contacts)))
    highest = max(float(_frictional_work(contact).max()) for contact in contacts.values())
    # Four decades of work, and beyond the largest one.
    limits = 1e-4 * highest, 2.0 * highest
    shown = [
        _draw_elements(axes, name, contact, laws, limits[0]) for name, contact in contacts.items()
    ]
    if not any(shown):
        raise ValueError("nothing to draw: no element wears; use a contact with slip and wear")
    axes.set(xscale="log", yscale="log", xlim=limits)
    _draw_laws(axes, next(iter(contacts.values())), laws, limits)
    axes.set_xlabel(r"frictional work $T\gamma/A$ (N/mm$^2$)")
    axes.set_ylabel(r"wear rate ($\mathrm{\mu g}$/(m mm$^2$))")
    _add_legend(figure)
    return figure


def _add_legend(figure: Figure, rows: int = 12) -> None:
    """Add a legend next to the axes, in columns of at most `rows` entries."""
    entries = sum(len(axes.get_legend_handles_labels()[1]) for axes in figure.axes)
    columns = -(-entries // rows)
    width, height = figure.get_size_inches().tolist()
    legend = figure.legend(loc="outside right center", ncols=columns, columnspacing=1.0)
    if columns > 1:  # the figure becomes wider
        legend_width = legend.get_window_extent().width / figure.dpi
        figure.set_size_inches(width + legend_width * (1.0 - 1.0 / columns), height)


def _last_contacts(source: History | State) -> dict[str, State]:
    """Return the last stored contact of each block by name ("" without blocks)."""
    if isinstance(source, State):
        return {"": source}
    blocks = {name: source.block(k) for k, name in enumerate(source.block_names)}
    return {name: history.state() for name, history in (blocks or {"": source}).items()}


def _wear_law(contact: State, laws: "ts.Laws | None", *, warm: bool) -> "ts.WearLaw | None":
    """Return the wear law of a contact, at its temperature if `warm`; None without wear."""
    # Loads compilers, which no other figure needs.
    from tractive_sam.contact import Laws, Model, wear_law_at  # noqa: PLC0415

    laws = laws or Laws.of_contact(contact, ("wear",))
    model = Model(contact.scene, grid=contact.grid, laws=laws)
    return wear_law_at(model, contact) if warm else model.wear_law


def _wear_rates(contact: State, laws: "ts.Laws | None") -> dict[str, np.ndarray]:
    """Return wear rates (n_x, n_y) of each body that wears, µg/(m mm²); empty without wear."""
    law = _wear_law(contact, laws, warm=True)
    fields = contact.pressure, contact.traction, contact.slip
    if law is None or not contact.touching.any():
        return {}
    if isinstance(law, mechanics.PerBody):
        separate = {body: getattr(law, body) for body in BODIES}
        rates = {body: part.rate(*fields) for body, part in separate.items() if part is not None}
    else:
        share, of_bodies = contact.scene.wear_share, law.shares(*fields)
        if of_bodies is not None:
            share = dict(zip(BODIES, of_bodies, strict=True))
        rates = {body: share[body] * law.rate(*fields) for body in BODIES}
    # 1e3 µg/(m mm²) for 1 kg/m³ and a depth equal to the sliding distance.
    density = {body: getattr(contact.scene.body, body).density for body in rates}
    return {body: 1e3 * density[body] * rate for body, rate in rates.items()}


def _frictional_work(contact: State) -> np.ndarray:
    """Return the frictional work of the elements over their area, N/mm², shape (n_x, n_y)."""
    return np.maximum(-(contact.traction * contact.slip).sum(axis=0), 0.0)


def _draw_elements(
    axes: Axes, name: str, contact: State, laws: "ts.Laws | None", lowest: float
) -> bool:
    """Draw wear rate over work of a contact's elements; return whether any element wears."""
    work, rates = _frictional_work(contact), _wear_rates(contact, laws)
    alike = len(rates) == 2 and np.allclose(rates["A"], rates["B"], rtol=1e-9)
    has_elements = False
    for body, marker in (("A", "o"), ("B", "^")):
        rate = rates.get(body, np.zeros_like(work))
        wears = (rate > 0.0) & (work > lowest)
        if wears.any() and not (alike and body == "B"):
            label = ", ".join(filter(None, (name, "A and B" if alike else body)))
            axes.plot(work[wears], rate[wears], marker, markersize=3, alpha=0.6, label=label)
            has_elements = True
    return has_elements


def _draw_laws(
    axes: Axes, contact: State, laws: "ts.Laws | None", limits: tuple[float, float]
) -> None:
    """Draw the wear laws that have regimes over work, with the limits of their regimes."""
    law, wear = _wear_law(contact, laws, warm=False), contact.scene.wear
    label = "law, without heat" if wear is not None and wear.temperature else "law"
    lines: list[object] = []
    for body in BODIES:
        regimes = getattr(getattr(law, body, None), "regimes", None)
        if regimes is None or getattr(getattr(law, body), "element_area", None) or regimes in lines:
            continue
        lines.append(regimes)
        work = np.geomspace(*limits, 400)
        axes.plot(work, regimes(work)[0], color=LOOK.grey, linewidth=1.0, zorder=0, label=label)
        for start in regimes.starts[1:]:
            if start < limits[1]:
                axes.axvline(start, color=LOOK.grey, linewidth=0.6, linestyle=":", zorder=0)
