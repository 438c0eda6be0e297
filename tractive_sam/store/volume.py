"""Writes stress in a volume, and the surface over a history, as VTKHDF for ParaView.

The file contains an image, a grid of equal distances: here the centres of the elements in equal
layers. Every version of VTKHDF can read an image, and an image needs no coordinates.

    /VTKHDF                 attributes: Version, Type, WholeExtent, Origin, Spacing, Direction
    /VTKHDF/PointData       stress (z, y, x, 6), von_mises and max_shear (z, y, x)
    /VTKHDF/Steps           of a surface: attribute NSteps, and Values, revolutions or distances;
                            its arrays pressure, wear, gap (step, y, x), traction and slip
                            (step, y, x, 3) have no z: VTK reads no z of flat images
    /scene                  the TOML text; attributes of the root: format, format_version, body,
                            revolution, versions

Source: VTKHDF file format, docs.vtk.org.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.mechanics import CRITERIA, VON_MISES
from tractive_sam.results import FIELDS, Quantity
from tractive_sam.scene import Scene
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.layout import create_text, set_text, versions
from tractive_sam.store.opening import decode_text, open_to_read
from tractive_sam.store.write_access import (
    WritableFile,
    atomic_rewrite,
    check_writable,
    sole_writer,
)

FORMAT = "tractive-sam volume"
VTKHDF_VERSION = (1, 0)
"""The first version; the format of an image has not changed since."""

WITH_STEPS = (2, 0)
"""The first version with steps (ParaView 5.12)."""

VTK_ORDER = [0, 1, 2, 3, 5, 4]
"""Indices of VTK's components xx, yy, zz, xy, yz, xz in our order xx, yy, zz, xy, xz, yz."""

VOLUME = {
    "stress": Quantity("stress", "MPa", "stress in the axes of the contact, xx, yy, zz, xy, yz, xz")
} | {name: Quantity(name, law.unit, law.long_name) for name, law in CRITERIA.items()}
"""Arrays of a volume."""

SURFACE = {
    "pressure": FIELDS["pressure"],
    "traction": Quantity("traction", "MPa", "traction on body A, x, y and 0"),
    "slip": Quantity(
        "slip", "1", "slip of A relative to B, divided by the rolling speed: x, y and 0"
    ),
    "wear": FIELDS["wear"],
    "gap": FIELDS["gap"],
}
"""Arrays of a surface."""


@dataclass(frozen=True)
class Image:
    """Regular grid of points for ParaView, with x varying fastest.

    Attributes
    ----------
    points : tuple of int
        Number of points in x, y and z.
    origin : tuple of float
        Coordinates of the first point, mm.
    spacing : tuple of float
        Distances of the points in x, y and z, positive, mm.
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
    """Write stress layer by layer to a VTKHDF file, which appears when it is complete.

    Parameters
    ----------
    path : Path
        The file, with `suffix`.
    image : Image
        The grid of points.
    layers : iterable of mapping of str to ndarray, shape (n_x, n_y) or (6, n_x, n_y)
        Arrays by the names of `VOLUME`, from the lowest z to the highest; stress as xx, yy, zz,
        xy, xz, yz. Stored in single precision.
    scene : Scene
        The scene that was computed.
    about : mapping of str to str or number
        Values of the attributes "body" and "revolution".
    overwrite : bool
        Whether an existing volume may be replaced. A file of another kind is never replaced.

    Raises
    ------
    ResultsError
        If the file cannot be written, or a file exists that may not be replaced.
    """
    with _open_volume(path, scene, about, overwrite) as file:
        arrays = _create_arrays(file, image, VOLUME, image.points[2:])
        for k, layer in enumerate(layers):
            for name, values in layer.items():
                arrays[name][k] = (values[VTK_ORDER] if name == "stress" else values).T
            file.check()


def write_surface(
    path: Path,
    image: Image,
    steps: np.ndarray,
    states: Iterable[Mapping[str, np.ndarray]],
    scene: Scene,
    overwrite: bool = False,
) -> None:
    """Write surface fields step by step to a VTKHDF file, which appears when it is complete.

    Parameters
    ----------
    path, image, scene, overwrite
        See `write_volume`; the image is one point high.
    steps : ndarray, shape (n,)
        The time of ParaView: revolutions, or a rolling distance.
    states : iterable of mapping of str to ndarray, shape (n_x, n_y) or (2, n_x, n_y)
        Arrays by the names of `SURFACE`. Stored in single precision.

    Raises
    ------
    ResultsError
        See `write_volume`.
    """
    with _open_volume(path, scene, {}, overwrite) as file:
        arrays = _create_arrays(file, image, SURFACE, (steps.size,))
        file["VTKHDF"].attrs["Version"] = np.array(WITH_STEPS, "i8")
        group = file["VTKHDF"].create_group("Steps")
        group.attrs["NSteps"] = steps.size
        group["Values"] = np.asarray(steps, float)
        offsets = group.create_group("PointDataOffsets")
        for name in arrays:
            offsets[name] = np.arange(steps.size)
        for k, state in enumerate(states):
            for name, values in state.items():
                # Our vectors have two components, vectors of ParaView three.
                third = () if values.ndim == 2 else (np.zeros((1, *values.shape[1:])),)
                arrays[name][k] = np.concatenate((values, *third)).T
            file.check()


@contextmanager
def _open_volume(
    path: Path, scene: Scene, about: Mapping[str, str | float], overwrite: bool
) -> Iterator[WritableFile]:
    """Yield a new VTKHDF file with scene and versions; it appears when the block ends."""
    format_version = 1
    version_prefix = "version_"
    _check_suffix(path)
    with sole_writer(path, overwrite, _check_kind), atomic_rewrite(path, empty=True) as file:
        create_text(file, "scene", scene.to_toml())
        set_text(file, "format", FORMAT)
        file.attrs.update({"format_version": format_version, **about})
        file.attrs.update({version_prefix + k: version for k, version in versions().items()})
        yield file


def check_volume(path: Path, overwrite: bool = False) -> None:
    """Raise a ResultsError unless a .vtkhdf file can be written, before it is computed.

    Raises
    ------
    ResultsError
        If the name has another suffix, or see `check_writable`.
    """
    _check_suffix(path)
    check_writable(path, overwrite, _check_kind)


def _check_suffix(path: Path) -> None:
    """Raise a ResultsError unless a file has the suffix .vtkhdf, by which ParaView opens it."""
    # Suffix by which ParaView recognizes the format.
    suffix = ".vtkhdf"
    if path.suffix != suffix:
        raise ResultsError(
            f"{path} has another suffix than {suffix}, which ParaView needs; change the name"
        )


def _check_kind(path: Path) -> None:
    """Raise a ResultsError unless an existing file is a volume of this package."""
    try:
        with open_to_read(path) as file:
            kind = decode_text(file.attrs.get("format", ""))
    except Exception:  # h5py raises many types of errors for damaged files
        kind = None
    if kind != FORMAT:
        raise ResultsError(f"{path} is not a volume of tractive-sam")


def _create_arrays(
    file: h5py.File, image: Image, quantities: Mapping[str, Quantity], outer: tuple[int, ...]
) -> dict[str, h5py.Dataset]:
    """Write the grid of points and create its arrays; return them by name."""
    # Number of components of vectors and tensors.
    components = {"stress": (6,), "traction": (3,), "slip": (3,)}
    vtk = file.create_group("VTKHDF")
    vtk.attrs["Version"] = np.array(VTKHDF_VERSION, "i8")
    vtk.attrs["Type"] = np.bytes_("ImageData")  # the format requires ASCII of exactly this length
    vtk.attrs["WholeExtent"] = np.array([(0, n - 1) for n in image.points], "i8").ravel()
    vtk.attrs["Origin"] = np.array(image.origin)
    vtk.attrs["Spacing"] = np.array(image.spacing)
    vtk.attrs["Direction"] = np.eye(3).ravel()
    data = vtk.create_group("PointData")
    arrays = {}
    for name, quantity in quantities.items():
        shape = (*outer, image.points[1], image.points[0], *components.get(name, ()))
        arrays[name] = data.create_dataset(
            name,
            shape,
            "f4",
            chunks=(*(1 for _ in outer), *shape[len(outer) :]),
            compression="gzip",
            compression_opts=1,
            shuffle=True,
            fletcher32=True,
        )
        arrays[name].attrs.update(quantity.attributes)
    first = arrays[VON_MISES.name if VON_MISES.name in arrays else "pressure"]
    first.attrs["Attribute"] = np.bytes_("Scalars")  # ParaView shows this array first
    return arrays
