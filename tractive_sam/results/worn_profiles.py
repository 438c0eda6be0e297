"""Worn profiles of a wheel and a rail, read from a history."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import ClassVar

import numpy as np

from tractive_sam.output_file import make_folder, write_table
from tractive_sam.rail import Profile, write_profile
from tractive_sam.results.history import History
from tractive_sam.results.quantity import Quantity
from tractive_sam.scene import Scene, unworn_profiles


@dataclass(frozen=True, eq=False)
class WornProfiles:
    """Wheel and rail profiles after each wear step, from a history with [wheel] and [wear].

    Attributes
    ----------
    scene : Scene
        The computed scene.
    revolutions : ndarray, shape (n,)
        Revolutions of the wheel after each step, the first one 0.
    wheel_depth, rail_depth : ndarray, shape (n, m)
        Depth worn off along the normals at the nodes of the profiles, mm.
    contact_y : ndarray, shape (n, blocks)
        Lateral position on the rail of the patch with most load in each block, mm.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.WornProfiles.from_history(ts.roll(scene))
    >>> bool(worn.wheel_depth[-1].max() > 0.0)
    True
    """

    columns: ClassVar[tuple[Quantity, ...]] = (
        Quantity("wheel_wear", "mm", "depth worn off the wheel, normal to it", dims=("wheel",)),
        Quantity("rail_wear", "mm", "depth worn off the rail, normal to it", dims=("rail",)),
        Quantity(
            "worn_section",
            "mm2",
            "cross section worn off each body since it was new",
            dims=("body",),
        ),
        Quantity(
            "wear_max_error", "mm", "error bar of wear_max due to its steps", error_of="wear_max"
        ),
        Quantity(
            "profile_work", "N", "frictional work per length of track since the bodies were new"
        ),
    )
    """Columns of a history with worn profiles."""

    scene: Scene
    revolutions: np.ndarray
    wheel_depth: np.ndarray
    rail_depth: np.ndarray
    contact_y: np.ndarray

    @classmethod
    def from_history(cls, history: History) -> WornProfiles:
        """Read worn wheel and rail profiles from the history of a scene with [wheel] and [wear].

        Raises
        ------
        ValueError
            If the history belongs to another scene.
        """
        if "wheel_wear" not in history.columns:
            raise ValueError(
                "the history has no worn profiles; roll a scene with [wheel] and [wear]"
            )
        name = "block_contact_y" if history.block_names else "contact_y"
        contact_y = history[name].reshape(len(history), -1)
        wheel, rail = history["wheel_wear"], history["rail_wear"]
        return cls(history.scene, history["revolution"], wheel, rail, contact_y)

    def wheel(self, step: int = -1) -> Profile:
        """Return the wheel profile after a wear step (default: the last), in its own frame."""
        return self.new["wheel"].worn(self.wheel_depth[step], 1.0)

    def rail(self, step: int = -1) -> Profile:
        """Return the rail profile after a wear step (default: the last), in its own frame."""
        return self.new["rail"].worn(self.rail_depth[step], -1.0)

    @property
    def worn_areas(self) -> dict[str, np.ndarray]:
        """Cross section worn off "wheel" and "rail" after each step, shape (n,), mm2."""
        depths = {"wheel": self.wheel_depth, "rail": self.rail_depth}
        return {name: np.trapezoid(depths[name], new.s, axis=1) for name, new in self.new.items()}

    @property
    def new(self) -> dict[str, Profile]:
        """Unworn profiles of "wheel" and "rail", in their own frames."""
        sizes = self.wheel_depth.shape[1], self.rail_depth.shape[1]
        return dict(zip(("wheel", "rail"), unworn_profiles(self.scene, *sizes), strict=True))

    def write(self, folder: str | PathLike[str]) -> list[Path]:
        """Write the last profiles (.prw, .prr), and area and largest depth by step (.csv).

        Returns
        -------
        list of Path
            The files.
        """
        folder = make_folder(folder)
        last = f"{self.revolutions[-1]:g}"
        files = [folder / f"wheel-{last}.prw", folder / f"rail-{last}.prr", folder / "wear.csv"]
        title = f"{self.scene.title}, worn for {last} revolutions"
        write_profile(self.wheel(), files[0], "wheel", title)
        write_profile(self.rail(), files[1], "rail", title)
        areas = self.worn_areas
        depths = {"wheel": self.wheel_depth, "rail": self.rail_depth}
        columns = {"revolution": self.revolutions}
        columns |= {f"{name}_area": area for name, area in areas.items()}
        columns |= {f"{name}_depth": depth.max(axis=1) for name, depth in depths.items()}
        write_table(files[2], columns)
        return files
