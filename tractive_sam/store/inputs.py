"""Content of the files that a scene names, in a results file."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.rail import Profile, RailSections
from tractive_sam.results import Quantity
from tractive_sam.scene import FileContent, Scene
from tractive_sam.store.datasets import COMPRESSED, create_scale, describe_dataset, set_text
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import ResultsFile, open_results

_PARTS = ("y", "z", "tangent_y", "tangent_z")
"""Numbers of profiles: points and tangents."""


def add_inputs(file: h5py.File, scene: Scene) -> None:
    """Add the content of the files that a scene names, with its hashes, to a results file."""
    for key, (_, content, reading) in scene.inputs.items():
        group = file.require_group("inputs").create_group(key)
        hashes = json.dumps(content.hashes)
        for name, text in (("path", content.path), ("hashes", hashes), ("reading", reading)):
            set_text(group, name, text)
        parsed = content.get(reading)
        if notes := getattr(parsed, "notes", ()):
            set_text(group, "notes", json.dumps(notes))
        match parsed:
            case Profile() as profile:
                _add_arrays(group, {"s": profile.s}, _split(profile.points, profile.tangents))
            case RailSections() as rail:
                axes = {"x": rail.x, "node": np.arange(float(rail.points.shape[1]))}
                _add_arrays(group, axes, _split(rail.points, rail.tangents))
            case (x, y, separation):
                _add_arrays(group, {"x": x, "y": y}, {"separation": separation})


def read_inputs(file: ResultsFile) -> list[FileContent]:
    """Return the contents of the files that the scene of a results file names."""
    contents: dict[str, FileContent] = {}
    for key in file.names("inputs") if "inputs" in file else ():
        group = f"inputs/{key}"
        path, hashes, reading = (file.text(group, name) for name in ("path", "hashes", "reading"))
        try:
            files = {str(name): str(digest) for name, digest in json.loads(hashes).items()}
            content = contents.setdefault(path, FileContent(path, files, is_stored=True))
            if f"{group}/separation" in file:  # may be large
                content.parsed[reading] = partial(_read_map, file.path, group, hashes)
            elif f"{group}/z" in file:
                content.parsed[reading] = _read_profile(file, group)
        except (ValueError, AttributeError) as error:
            raise file.damage_error(f"{group}: {error}") from None
    return [*contents.values()]


def _split(points: np.ndarray, tangents: np.ndarray) -> dict[str, np.ndarray]:
    """Return the parts of points and tangents, shape (..., 2), by name."""
    parts = np.moveaxis(np.concatenate((points, tangents), axis=-1), -1, 0)
    return dict(zip(_PARTS, parts, strict=True))


def _add_arrays(
    group: h5py.Group, axes: dict[str, np.ndarray], arrays: dict[str, np.ndarray]
) -> None:
    """Add the axes of arrays as scales, and the arrays with checksums."""
    about = {
        "x": "position along the track",
        "y": "lateral position",
        "z": "height, positive downwards",
        "s": "arc length",
        "node": "number of a point of a section",
        "tangent_y": "derivative of y",
        "tangent_z": "derivative of z",
        "separation": "separation added to the radii",
    }
    for name, values in axes.items():
        create_scale(group, name, values, Quantity(name, "mm", about[name]))
    for name, values in arrays.items():
        dataset = group.create_dataset(
            name, data=values, chunks=True, fletcher32=True, **COMPRESSED
        )
        for k, axis in enumerate(axes):
            h5py.h5ds.attach_scale(dataset.id, group[axis].id, k)
        describe_dataset(dataset, Quantity(name, "mm", about[name]))


def _read_profile(file: ResultsFile, group: str) -> Profile | RailSections:
    """Return the profile, or the sections of a rail, in a group; ValueError for wrong shapes."""
    parts = np.stack([file.all_numbers(f"{group}/{name}") for name in _PARTS], axis=-1)
    kind: Any = Profile if f"{group}/s" in file else RailSections
    along = file.all_numbers(f"{group}/{'s' if kind is Profile else 'x'}")
    if parts.shape[:1] != along.shape or not np.isfinite(parts).all():
        raise ValueError(f"a profile of the shape {parts.shape}")
    notes = tuple(map(str, json.loads(file.text(group, "notes", "[]"))))
    return kind(along, parts[..., :2], parts[..., 2:], notes)


def _read_map(path: Path, group: str, hashes: str) -> tuple[np.ndarray, ...]:
    """Return x, y and separation in a results file; ResultsError if it has been replaced."""
    with open_results(path) as file:
        if "inputs" not in file or file.text(group, "hashes") != hashes:
            raise ResultsError(f"{path} has been replaced since it was opened; open it again")
        x, y, separation = (
            file.all_numbers(f"{group}/{name}") for name in ("x", "y", "separation")
        )
        if separation.shape != (x.size, y.size) or not np.isfinite(separation).all():
            raise file.damage_error(f"{group}: a separation of the shape {separation.shape}")
    return x, y, separation
