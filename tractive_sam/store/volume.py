"""Writes stress in a volume as VTKHDF, which ParaView opens.

The file holds an image: points at equal distances, here the centres of the elements over equal
layers. Of all kinds of grid that VTKHDF knows, an image is the one that every version since the
first reads, and it costs no coordinates.

    /VTKHDF                 attributes: Version, Type, WholeExtent, Origin, Spacing, Direction
    /VTKHDF/PointData       stress (z, y, x, 6), von_mises and max_shear (z, y, x)
    /scene                  the TOML text, beside what readers look at; attributes of the root:
                            format, format_version, body, revolution, versions

Source: VTKHDF file format, docs.vtk.org.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.mechanics import CRITERIA, VON_MISES
from tractive_sam.results import Quantity
from tractive_sam.scene import Scene
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.replacement import replacement
from tractive_sam.store.room import make_room, sole_writer
from tractive_sam.store.texts import create_text, set_text, text_of
from tractive_sam.store.versions import versions

SUFFIX = ".vtkhdf"
"""By which ParaView knows the format."""

VERSION_PREFIX = "version_"

FORMAT = "tractive-sam volume"
FORMAT_VERSION = 1

VTKHDF_VERSION = (1, 0)
"""The first one; an image has not changed since."""

VTK_ORDER = [0, 1, 2, 3, 5, 4]
"""VTK's xx, yy, zz, xy, yz, xz of our xx, yy, zz, xy, xz, yz."""

QUANTITIES = {
    "stress": Quantity(
        "stress", "MPa", "stress in the axes of the contact, xx, yy, zz, xy, yz, xz"
    ),
} | {name: Quantity(name, one.unit, one.long_name) for name, one in CRITERIA.items()}
"""Arrays of the file."""


@dataclass(frozen=True)
class Image:
    """Points at equal distances, of which x counts fastest.

    Attributes
    ----------
    points : tuple of int
        Number of points in x, y and z.
    origin : tuple of float
        The first one, mm.
    spacing : tuple of float
        Distances, positive, mm.
    """

    points: tuple[int, int, int]
    origin: tuple[float, float, float]
    spacing: tuple[float, float, float]


def write_volume(
    path: Path,
    image: Image,
    layers: Iterable[Mapping[str, np.ndarray]],
    scene: Scene,
    about: Mapping[str, str | float],
    overwrite: bool = False,
) -> None:
    """Write layers as they come; the file appears when all are written.

    Parameters
    ----------
    path : Path
        The file, with `SUFFIX`.
    image : Image
        Where the points are.
    layers : iterable of mapping of str to ndarray, shape (n_x, n_y) or (6, n_x, n_y)
        By the names of `QUANTITIES`, from the lowest z to the highest; stress as xx, yy, zz, xy,
        xz, yz. Stored in single precision.
    scene : Scene
        What was computed.
    about : mapping of str to str or number
        "body" and "revolution".
    overwrite : bool
        Whether a volume there may be replaced. A file of any other kind never is.

    Raises
    ------
    ResultsError
        If the file cannot be written, or there is one that may not be replaced.
    """
    _check_suffix(path)
    with sole_writer(path, overwrite, _check_kind), replacement(path, empty=True) as file:
        create_text(file, "scene", scene.to_toml())
        set_text(file, "format", FORMAT)
        file.attrs.update({"format_version": FORMAT_VERSION, **about})
        file.attrs.update({VERSION_PREFIX + k: version for k, version in versions().items()})
        arrays = _laid_out(file, image)
        for k, layer in enumerate(layers):
            for name, values in layer.items():
                arrays[name][k] = (values[VTK_ORDER] if name == "stress" else values).T


def check_volume(path: Path, overwrite: bool = False) -> None:
    """See that a volume can be written, before it is computed.

    Raises
    ------
    ResultsError
        If the name has not the suffix, or as by `make_room`.
    """
    _check_suffix(path)
    make_room(path, overwrite, _check_kind)


def _check_suffix(path: Path) -> None:
    if path.suffix != SUFFIX:
        raise ResultsError(
            f"{path} has not the suffix {SUFFIX}, by which ParaView knows the format"
        )


def _check_kind(path: Path) -> None:
    try:
        with h5py.File(path, "r") as file:
            kind = text_of(file.attrs.get("format", ""))
    except Exception:  # h5py has no one kind of error for what is damaged
        kind = None
    if kind != FORMAT:
        raise ResultsError(f"{path} is no volume of tractive-sam")


def _laid_out(file: h5py.File, image: Image) -> dict[str, h5py.Dataset]:
    """Describe the image, and make room for its arrays."""
    vtk = file.create_group("VTKHDF")
    vtk.attrs["Version"] = np.array(VTKHDF_VERSION, "i8")
    set_text(vtk, "Type", "ImageData", "ascii")
    vtk.attrs["WholeExtent"] = np.array([(0, n - 1) for n in image.points], "i8").ravel()
    vtk.attrs["Origin"] = np.array(image.origin)
    vtk.attrs["Spacing"] = np.array(image.spacing)
    vtk.attrs["Direction"] = np.eye(3).ravel()
    data = vtk.create_group("PointData")
    shape = image.points[::-1]
    arrays = {}
    for name, quantity in QUANTITIES.items():
        whole = (*shape, 6) if name == "stress" else shape
        arrays[name] = data.create_dataset(
            name,
            whole,
            "f4",
            chunks=(1, *whole[1:]),
            compression="gzip",
            compression_opts=1,
            shuffle=True,
            fletcher32=True,
        )
        arrays[name].attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
    set_text(arrays[VON_MISES.name], "Attribute", "Scalars", "ascii")  # what is shown first
    return arrays
