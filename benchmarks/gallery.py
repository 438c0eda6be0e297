"""Draw the pictures of the gallery: what does the program show for its built-in scenes?

Page: docs/gallery.md
"""

import tempfile
from pathlib import Path

from timing import RESULTS

import tractive_sam as ts
from tractive_sam import plot

PICTURES = {
    "twin-discs": ("traction-0", "worn-profiles", "von-mises-y0-15000"),
    "spheres-orthotropic": ("stick-slip",),
    "hot-discs": ("temperature",),
    "locomotive": ("friction",),
    "wheel-flange": ("wheel-rail-1",),
    "fretting": ("hysteresis",),
    "traction-control": ("forces",),
    "ball-in-groove": ("conformal-patch",),
    "inclusion": ("von-mises-inclusion-1", "passage-inclusion-1"),
    "coated-roller": ("traction-sections",),
    "rubber-roller": ("pressure",),
}
"""Figures of each scene, as `tractive-sam plot` names their files."""


def main():
    gallery = RESULTS / "gallery"
    gallery.mkdir(exist_ok=True)
    for name, figures in PICTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            history = ts.roll(ts.Scene.builtin(name), Path(folder) / "results.h5")
            plot.save_all(history, folder, dpi=100)
            for figure in figures:
                picture = gallery / f"{name}-{figure}.png"
                picture.write_bytes((Path(folder) / f"{figure}.png").read_bytes())
                print(f"written: {picture}")


if __name__ == "__main__":
    main()
