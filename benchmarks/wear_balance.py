"""Worn cross-section divided by the wear due to frictional work, for creepages and meshes.

The scenes are spheres in steady rolling at a thousandth of the creepage of full slip and more.
Friction is isotropic, or orthotropic with mu1/mu2 = 2.5 at 35 degrees. If i/mu is equal along both
axes, the worn cross-section is i/mu times the supplied work on any mesh.

- by work: `ArchardByWork`, the law of the package;
- by pressure: Archard's law p_n |s|_i with this slip; elements that stick next to a slipping
  element wear as if they slipped;
- by traction: the traction of an element replaces its pressure, ||p_t||_mu |s|_i;
- upwind: slip and law of the paper; its slip misses some of the work and therefore some of the
  wear.

If i/mu differs between the axes, there is no closed form. The script then gives the error relative
to the cross-section by work, extrapolated from meshes of 192 and 256 elements.

Page: docs/theory/wear.md
"""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, show, write

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium
from tractive_sam.mechanics.wear import Archard, ArchardByWork
from tractive_sam.results import State

SHARES = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0)
ACROSS = (16, 32, 64, 128)
FINER = (192, 256)
FRICTION = {
    "isotropic": ("friction.mu=0.4",),
    "orthotropic": ("friction.mu=[0.5, 0.2]", "friction.angle=35"),
}
INTENSITY = {
    "as friction": lambda mu: (1e-6 * mu[0], 1e-6 * mu[1]),
    "against friction": lambda mu: (1e-6 * mu[1], 1e-6 * mu[0]),
}


def solved(across: int, friction: str, creepage: str, share: float, slip: str) -> State:
    """Solve spheres at a share of the creepage of full slip, on elements across the contact."""
    scene = ts.Scene.builtin("spheres").replace(subsurface=None)
    hertz, material, load = scene.hertz, scene.material, scene.load.normal
    # Simplified theory; with mu = 0.4 for both kinds of friction (paper, section 8.1).
    full = 3 * 0.4 * load * (4 - 3 * material.poisson) / (16 * material.shear * hertz.a**2)
    elements = across + 2 * max(2, across // 16) + 1
    half_length = hertz.a * elements / across
    creepages = {"longitudinal": 0.0, creepage: -share * full}
    if creepage == "spin":
        creepages["spin"] /= hertz.a
    settings = (
        *FRICTION[friction],
        *(f"creepage.{name}={value}" for name, value in creepages.items()),
        f'solver.slip="{slip}"',
        f"grid.half_length=[{half_length}, {half_length}]",
        f"grid.elements=[{elements}, {elements}]",
    )
    return equilibrium(Model(scene.with_set(settings)))


def sections(contact: State, intensity: tuple[float, float]) -> dict[str, float]:
    """Return the cross-section worn by each law, mm²."""
    friction = contact.scene.friction
    angle, mu = np.deg2rad(friction.angle), friction.mu
    letter = Archard(intensity, angle)
    borne = np.hypot(*Model(contact.scene).frame.to_scaled(contact.traction))
    fields = contact.traction, contact.slip
    rates = {
        "by work": ArchardByWork(intensity, mu, angle).rate(contact.pressure, *fields),
        "by pressure": letter.rate(contact.pressure, *fields),
        "by traction": letter.rate(borne, *fields),
    }
    return {law: float(rate.sum()) * contact.grid.element_area for law, rate in rates.items()}


def cases() -> Iterator[tuple[str, str, float]]:
    """Yield friction, creepage and share of full slip."""
    for friction in FRICTION:
        for creepage in ("longitudinal", "spin"):
            for share in SHARES:
                yield friction, creepage, share


def balances() -> list[dict]:
    """Return cross-sections divided by the supplied work times i/mu, equal along both axes."""
    rows = []
    for friction, creepage, share in cases():
        for across in ACROSS:
            contact = solved(across, friction, creepage, share, "auto")
            intensity = INTENSITY["as friction"](contact.scene.friction.mu)
            worn = 1e-6 * contact.work_supplied
            ratios = {law: section / worn for law, section in sections(contact, intensity).items()}
            upwind = solved(across, friction, creepage, share, "upwind")
            ratios["upwind"] = sections(upwind, intensity)["by pressure"] / (
                1e-6 * upwind.work_supplied
            )
            about = {"friction": friction, "creepage": creepage, "of full slip": share}
            rows.append(about | {"across": across} | ratios)
    show("Worn cross-section / (i/mu times the supplied work)", rows)
    write("wear_balance", rows)
    return rows


def errors() -> None:
    """Return errors of the cross-section with exchanged intensities."""
    rows = []
    for creepage in ("longitudinal", "spin"):
        for share in SHARES:
            sections_by_mesh = {}
            for across in (*ACROSS, *FINER):
                contact = solved(across, "orthotropic", creepage, share, "auto")
                intensity = INTENSITY["against friction"](contact.scene.friction.mu)
                sections_by_mesh[across] = sections(contact, intensity)
            coarser, finer = (sections_by_mesh[across]["by work"] for across in FINER)
            # The rest is of first order if the slip zone is thinner than an element.
            truth = finer + (finer - coarser) * FINER[0] ** 2 / (FINER[1] ** 2 - FINER[0] ** 2)
            for across in ACROSS:
                ratios = {
                    law: section / truth - 1.0 for law, section in sections_by_mesh[across].items()
                }
                rows.append(
                    {"creepage": creepage, "of full slip": share, "across": across} | ratios
                )
    show("Error of the worn cross-section, i/mu different along the axes", rows)
    write("wear_balance_errors", rows)


def draw(rows: list[dict]) -> None:
    """Draw cross-section over work against creepage, one panel for each friction and creepage."""
    figure = Figure(figsize=(8.4, 5.8), layout="constrained")
    panels = list(dict.fromkeys((friction, creepage) for friction, creepage, _ in cases()))
    laws = {"by pressure": "C1", "by traction": "C2", "upwind": "C7", "by work": "C0"}
    for ax, (friction, creepage) in zip(figure.subplots(2, 2).flat, panels, strict=True):
        for law, colour in laws.items():
            for across, dash in zip((16, 64), ("--", "-"), strict=True):
                points = [
                    (row["of full slip"], row[law])
                    for row in rows
                    if (row["friction"], row["creepage"], row["across"])
                    == (friction, creepage, across)
                ]
                ax.loglog(*zip(*points, strict=True), dash, color=colour, label=f"{law}, {across}")
        ax.set(
            title=f"{friction}, {creepage}",
            xlabel="creepage / creepage of full slip",
            ylabel="worn cross-section / work",
            ylim=(
                0.1,
                50.0,
            ),  # upwind, nothing wears if the slip zone is thinner than an element
        )
    ax.legend(fontsize=7, ncols=2, title="law, elements across", title_fontsize=7)
    figure.savefig(RESULTS / "wear_balance.png", dpi=150)


if __name__ == "__main__":
    draw(balances())
    errors()
