"""Fields, stress and fatigue of single records, read from the file on access."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tractive_sam.results import COMPONENTS, FATIGUE_FIELDS, BodyFatigue, PlaneStress
from tractive_sam.scene import Plane
from tractive_sam.store.datasets import plane_path
from tractive_sam.store.opening import open_results


@dataclass(frozen=True)
class StoredField:
    """Sequence of the arrays of a field, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    name : str
        A name of `FIELDS`.
    length : int
        Number of records with fields.
    """

    path: Path
    name: str
    length: int

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> np.ndarray:
        """Return the field of a record, shape (n_x, n_y)."""
        with open_results(self.path) as file:
            return file.row(f"fields/{self.name}", range(self.length)[row])


@dataclass(frozen=True)
class StoredStress:
    """Sequence of `PlaneStress` on one plane, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    body, plane : str
        "A" or "B", and the plane as the scene names it.
    length : int
        Number of records with stress.
    block : int, optional
        Number of the block of a duty cycle.
    shift : float
        Lateral position of the running band of the block, mm; y counts from there.
    """

    path: Path
    body: str
    plane: str
    length: int
    block: int | None = None
    shift: float = 0.0

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> "PlaneStress":
        """Return the stress of a record, on the mesh that it was computed on."""
        with open_results(self.path) as file:
            group = f"stress/{plane_path(self.body, self.plane, self.block)}"
            names = [name for name in ("x", "y", "depth") if f"{group}/{name}" in file]
            lengths = {name: file.length(f"{group}/{name}") for name in names}
            axes = {name: file.numbers(f"{group}/{name}", (n,)) for name, n in lengths.items()}
            row = range(self.length)[row]
            components = {name: file.row(f"{group}/{name}", row) for name in COMPONENTS}
            position = float(file.attribute(group, "position"))
        # The mesh may have grown since; the stress outside the former mesh is nan.
        finite = np.isfinite(components[COMPONENTS[0]])
        inside = [np.flatnonzero(finite.any(axis=axis)) for axis in (1, 0)]
        axes = {name: axes[name][points] for name, points in zip(axes, inside, strict=True)}
        if "y" in axes:
            axes["y"] = axes["y"] - self.shift
        components = {name: values[np.ix_(*inside)] for name, values in components.items()}
        plane = Plane.parse(self.plane)
        return PlaneStress(self.body, plane, position, axes, components, self.block)


@dataclass(frozen=True)
class StoredCycles:
    """Sequence of a body's `BodyFatigue`, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    body : str
        "A" or "B".
    shear_yield : float
        Shear yield stress, MPa; see `BodyFatigue`.
    length : int
        Number of records.
    """

    path: Path
    body: str
    shear_yield: float
    length: int

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> BodyFatigue:
        """Return the fatigue of a record, without the criterion: only the scene names it."""
        row, empty = range(self.length)[row], np.zeros(0)
        with open_results(self.path) as file:
            group = f"fatigue/{self.body}"
            values = {
                name: file.row(f"{group}/{name}", row) if f"{group}/{name}" in file else empty
                for name in FATIGUE_FIELDS
            }
            axes = {
                name: file.all_numbers(f"{group}/{name}") if f"{group}/{name}" in file else empty
                for name in ("y", "depth", "zeta")
            }
        return BodyFatigue(
            self.body, **axes, **values, criterion=None, shear_yield=self.shear_yield
        )
