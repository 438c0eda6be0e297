"""What a results file holds of single records, read only when it is asked for."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tractive_sam.results import COMPONENTS, CYCLES, BodyFatigue, PlaneStress
from tractive_sam.scene import Plane
from tractive_sam.store.layout import place_of
from tractive_sam.store.opening import results_file


@dataclass(frozen=True)
class StoredField:
    """One field of several records, read from the file whenever a record is asked for.

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
        """The field of one record, shape (n_x, n_y)."""
        with results_file(self.path) as file:
            return file.row(f"fields/{self.name}", range(self.length)[row])


@dataclass(frozen=True)
class StoredStress:
    """Stress on one plane of several records, read from the file whenever a record is asked for.

    Attributes
    ----------
    path : Path
        The results file.
    body, plane : str
        "A" or "B", and the plane as the scene names it.
    length : int
        Number of records with stress.
    block : int, optional
        Of a duty cycle: which of its blocks.
    shift : float
        Where the band of that lies, mm; it counts y from there.
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
        """The stress of one record, on the mesh that it was computed on."""
        with results_file(self.path) as file:
            group = f"stress/{place_of(self.body, self.plane, self.block)}"
            names = [name for name in ("x", "y", "depth") if f"{group}/{name}" in file]
            lengths = {name: file.length(f"{group}/{name}") for name in names}
            axes = {name: file.numbers(f"{group}/{name}", (n,)) for name, n in lengths.items()}
            row = range(self.length)[row]
            components = {name: file.row(f"{group}/{name}", row) for name in COMPONENTS}
            position = float(file.attribute(group, "position"))
        # Beside a mesh that has grown since there is none.
        known = np.isfinite(components[COMPONENTS[0]])
        inside = [np.flatnonzero(known.any(axis=other)) for other in (1, 0)]
        axes = {name: axes[name][at] for name, at in zip(axes, inside, strict=True)}
        if "y" in axes:
            axes["y"] = axes["y"] - self.shift
        components = {name: values[np.ix_(*inside)] for name, values in components.items()}
        plane = Plane.parse(self.plane)
        return PlaneStress(self.body, plane, position, axes, components, self.block)


@dataclass(frozen=True)
class StoredCycles:
    """What rolling has done to one body by several records, read whenever one is asked for.

    Attributes
    ----------
    path : Path
        The results file.
    body : str
        "A" or "B".
    shear_yield : float
        As of `BodyFatigue`.
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
        """That of one record; which criterion was asked only the scene tells."""
        row, none = range(self.length)[row], np.zeros(0)
        with results_file(self.path) as file:
            group = f"fatigue/{self.body}"
            values = {
                name: file.row(f"{group}/{name}", row) if f"{group}/{name}" in file else none
                for name in CYCLES
            }
            axes = {
                name: file.whole(f"{group}/{name}") if f"{group}/{name}" in file else none
                for name in ("y", "depth", "zeta")
            }
        return BodyFatigue(
            self.body, **axes, **values, criterion=None, shear_yield=self.shear_yield
        )
