"""Worn section over what the work of friction wears, over creepage and mesh.

Spheres in steady rolling from a thousandth of the creepage of full slip on; the friction isotropic,
or orthotropic with mu1/mu2 = 2.5 at 35 degrees. Where i/mu is the same along both axes, i/mu times
the work supplied is the section worn, whatever the mesh.

- by work: `ArchardByWork`, the package's;
- by pressure: Archard's law p_n |s|_i with the same slip, in which elements that stick next to one
  that slips wear as if they slipped;
- by traction: with what an element carries in place of its pressure, ||p_t||_mu |s|_i;
- upwind: the paper's slip and law. Its slip misses some of the work, and with it of the wear.

Then the error of the section where i/mu differs, and there is no law to compare with: against
the section by work on meshes of 192 and 256 elements, extrapolated.

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
    """Spheres at a share of the creepage of full slip, on elements across the contact."""
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
    """Section worn by each law, mm²."""
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
    """Friction, creepage and share of full slip."""
    for friction in FRICTION:
        for creepage in ("longitudinal", "spin"):
            for share in SHARES:
                yield friction, creepage, share


def balances() -> list[dict]:
    """Sections over the work supplied times i/mu, the same along both axes."""
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
    show("Worn section over i/mu times the work supplied", rows)
    write("wear_balance", rows)
    return rows


def errors() -> None:
    """Errors of the section with the intensities exchanged against those of friction."""
    rows = []
    for creepage in ("longitudinal", "spin"):
        for share in SHARES:
            found = {}
            for across in (*ACROSS, *FINER):
                contact = solved(across, "orthotropic", creepage, share, "auto")
                intensity = INTENSITY["against friction"](contact.scene.friction.mu)
                found[across] = sections(contact, intensity)
            coarser, finer = (found[across]["by work"] for across in FINER)
            # The rest is of first order where the slip zone is thinner than an element.
            truth = finer + (finer - coarser) * FINER[0] ** 2 / (FINER[1] ** 2 - FINER[0] ** 2)
            for across in ACROSS:
                ratios = {law: section / truth - 1.0 for law, section in found[across].items()}
                rows.append(
                    {"creepage": creepage, "of full slip": share, "across": across} | ratios
                )
    show("Error of the worn section, i/mu not the same along both axes", rows)
    write("wear_balance_errors", rows)


def draw(rows: list[dict]) -> None:
    """Section over work against creepage, a panel for each friction and creepage."""
    figure = Figure(figsize=(8.4, 5.8), layout="constrained")
    panels = list(dict.fromkeys((friction, creepage) for friction, creepage, _ in cases()))
    laws = {"by pressure": "C1", "by traction": "C2", "upwind": "C7", "by work": "C0"}
    for ax, (friction, creepage) in zip(figure.subplots(2, 2).flat, panels, strict=True):
        for law, colour in laws.items():
            for across, dash in zip((16, 64), ("--", "-"), strict=True):
                kept = [
                    (row["of full slip"], row[law])
                    for row in rows
                    if (row["friction"], row["creepage"], row["across"])
                    == (friction, creepage, across)
                ]
                ax.loglog(*zip(*kept, strict=True), dash, color=colour, label=f"{law}, {across}")
        ax.set(
            title=f"{friction}, {creepage}",
            xlabel="creepage over that of full slip",
            ylabel="worn section over work",
            ylim=(
                0.1,
                50.0,
            ),  # upwind, nothing wears where the slip zone is thinner than an element
        )
    ax.legend(fontsize=7, ncols=2, title="law, elements across", title_fontsize=7)
    figure.savefig(RESULTS / "wear_balance.png", dpi=150)


if __name__ == "__main__":
    draw(balances())
    errors()
