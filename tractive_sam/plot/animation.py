"""An animation of the contact and the track that it wears, over the stored records."""

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image

from tractive_sam import interrupt
from tractive_sam.output_file import write_file
from tractive_sam.plot.contact_map import ContactMap, MapFrame, MapLayout, add_axes, new_map_figure
from tractive_sam.plot.contact_view import WIDE, ContactView, select_evenly
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import LOOK, MICRON, apply_style
from tractive_sam.results import History


@apply_style
def animate(history: History, path: str | Path, rate: float = 2.0) -> Path:
    """Draw pressure and wear, or traction of a [transient], as an animated GIF; return its path.

    For a [transient] it shows the traction and the edge of stick at the stored distances.

    Parameters
    ----------
    history : History
        History to draw; its fields are read record by record.
    path : path-like
        File to write; a name that ends in ".gif".
    rate : float
        Records per second.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the name has another ending, fewer than two records are stored, or the bodies touch
        along a line, which has no map.

    Examples
    --------
    >>> plot.animate(history, "discs.gif").name
    'discs.gif'
    """
    path = Path(path)
    if path.suffix.lower() != ".gif":
        raise ValueError(f'path: a name that ends in ".gif"; not {path.name!r}')
    WIDE.check(history)
    if len(history.saved) < 2:
        raise ValueError(
            "an animation needs at least two stored records, there is "
            f"{len(history.saved)}: list more in {history.scene.schedule.save_key}"
        )
    envelope = _envelope(history)
    frame = MapFrame.from_contacts(envelope, width=0.6 * LOOK.width)
    # In a history in steps the edge of stick moves while A is shifted over B.
    track, draw = (0.0, _draw_traction) if "shift_x" in history.columns else (1.6, _draw_wear)
    layout = MapLayout.current()
    width = layout.row_width(frame, 1) + track + 0.2
    figure = new_map_figure(width, frame, history.title, positions=True)
    pictures = []
    # Once saved, a figure without a layout takes the layout of the settings.
    with mpl.rc_context({"figure.constrained_layout.use": False}):
        for view in _views(history):
            for axes in list(figure.axes):
                axes.remove()
            chart = ContactMap(figure, layout.left, view, frame)
            chart.axes.set_title(view.position, loc="center")
            draw(chart, envelope)
            pictures.append(_rasterize(figure))
    memory, duration = BytesIO(), int(1000 / rate)
    first, *further = pictures
    first.save(memory, "gif", save_all=True, append_images=further, duration=duration, loop=0)
    return write_file(path, memory.getbuffer())


def _rasterize(figure: Figure, dpi: int = 110) -> Image.Image:
    """Return a figure as an image of pixels."""
    memory = BytesIO()
    figure.savefig(memory, format="png", dpi=dpi)
    return Image.open(memory).convert("RGB")


def _views(history: History, max_frames: int = 100) -> Iterator[ContactView]:
    """Yield at most `max_frames` stored contacts, evenly spaced over the records."""
    for at in select_evenly(history.saved, max_frames):
        interrupt.raise_if_interrupted()
        yield ContactView.from_source(history, at)


def _envelope(history: History) -> ContactView:
    """Return the first contact with each element's largest pressure and wear over all records."""
    views = _views(history)
    envelope = next(views)
    for view in views:
        pressure = np.maximum(envelope.contact.pressure, view.contact.pressure)
        wear = np.maximum(envelope.contact.wear, view.contact.wear)
        contact = replace(envelope.contact, pressure=pressure, wear=wear)
        envelope = replace(envelope, contact=contact)
    return envelope


def _draw_wear(chart: ContactMap, envelope: ContactView) -> None:
    """Draw one frame: the pressure map, and the wear depth over y next to it."""
    view, frame, layout = chart.view, chart.frame, MapLayout.current()
    p = view.scale.pressure
    highest = envelope.contact.pressure.max() / p
    mesh = chart.fill(view.contact.pressure / p, cmap=LOOK.pressure, vmin=0.0, vmax=highest)
    chart.add_colour_bar(mesh, f"contact pressure {view.scale.pressure_label('p_n')}")
    right = layout.left + frame.width + layout.right
    track = add_axes(chart.figure, right, layout.bottom, 1.6, frame.height)
    track.plot(MICRON * view.contact.wear[0], view.y_over_a, color=LOOK.blue)
    deepest = 1.05 * MICRON * envelope.contact.wear.max() or 1.0
    track.set(xlim=(0.0, deepest), ylim=(frame.bottom, frame.top), xlabel=r"$w$ ($\mathrm{\mu m}$)")
    track.yaxis.set_major_locator(chart.axes.yaxis.get_major_locator())
    track.tick_params(labelleft=False)


def _draw_traction(chart: ContactMap, envelope: ContactView) -> None:
    """Draw one frame: the traction map with the edge of stick.

    The colours end at the largest contact pressure of all records: no traction is larger.
    """
    view = chart.view
    p = view.scale.pressure
    highest = envelope.contact.pressure.max() / p
    mesh = chart.fill(view.contact.utilisation / p, cmap=LOOK.traction, vmin=0.0, vmax=highest)
    if view.contact.touching.any():
        chart.draw_stick_edge()
        chart.draw_arrows(view.contact.traction, view.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if view.isotropic else r"\|p_t\|_\mu"
    chart.add_colour_bar(mesh, f"traction over friction {view.scale.pressure_label(symbol)}")
