"""The [fit] table of a fit file, and the checks between its entries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

from tractive_sam.fitting.entries import base_of, start_of
from tractive_sam.fitting.tables import COORDINATES, CandidateTest, Data, Names, Parameter
from tractive_sam.scene import Scene
from tractive_sam.schema import (
    Check,
    Document,
    Fault,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    shorten,
    suggest_name,
)


class FitError(SceneError):
    """Error: a fit cannot be made; lists every fault that was found.

    Examples
    --------
    >>> try:
    ...     ts.FitDesign(fit={"scene": "spheres", "free": "friction.mu"})
    ... except ts.FitError as error:
    ...     print(error.faults[0].key)
    fit.data
    """

    subject: ClassVar[str] = "fit"


def _check_parameters(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of [[parameter]] tables with a key that is not free or is given twice."""
    free = entries["free"]
    for k, table in enumerate(entries["parameter"]):
        if table.key not in free:
            yield Fault(f"parameter[{k}].key", shorten(table.key), suggest_name(table.key, free))
    keys = [table.key for table in entries["parameter"]]
    for key in {key for key in keys if keys.count(key) > 1}:
        yield Fault("parameter", f"{key} {keys.count(key)} times", "one table for each key")


def _check_free_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of free keys without a numeric start, or of a pair freed with its numbers."""
    parameters = {table.key: table for table in entries["parameter"]}
    for key in entries["free"]:
        try:
            start_of(entries["scene"], key, parameters[key].start if key in parameters else None)
        except SceneError as error:
            yield from (Fault("free", f"{shorten(key)}: {fault.given}", fault.allowed)
                        for fault in error.faults)  # fmt: skip
    for key in entries["free"]:
        if key != base_of(key) and base_of(key) in entries["free"]:
            yield Fault("free", f"{key} and {base_of(key)}", "the pair or its numbers, not both")


def _check_varied_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of varied or set keys that are free or unknown."""
    bases = {base_of(key) for key in entries["free"]}
    for name in ("data", "test"):
        for k, data in enumerate(entries[name]):
            varied = (data.vary,) if isinstance(data.vary, str) else data.vary or ()
            chosen = [key for key in varied if name == "test" or key not in COORDINATES]
            for source, key in [
                *(("vary", key) for key in chosen),
                *(("set", k) for k in data.set),
            ]:
                if key in bases:
                    yield Fault(f"{name}[{k}].{source}", key, "an entry that is not free")
                elif (fault := _find_unknown_key(key)) is not None:
                    yield Fault(f"{name}[{k}].{source}", shorten(key), fault.allowed)


def _find_unknown_key(key: str) -> Fault | None:
    """Return the fault of a key that scenes do not have, or None if they have it."""
    try:
        Scene.find_field(base_of(key))
    except SceneError as error:
        return error.faults[0]
    return None


def _check_target(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault if the target of the next test is not a free key."""
    target, free = entries["target"], entries["free"]
    if target is not None and target not in free:
        yield Fault("target", shorten(target), suggest_name(target, free))


def _check_mesh(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault if the scene has [accuracy], since fits need a constant mesh."""
    if entries["scene"].accuracy is not None:
        cure = "a [grid] or none: the mesh of a fit is fixed while parameters vary"
        yield Fault("scene.accuracy", "a table", cure)


class Fit(Table):
    """The [fit] table of a fit file: scene, free keys, data sets, and settings of the search.

    Examples
    --------
    >>> from tractive_sam.fitting.design import Fit
    >>> creep = {"values": {"Qx": [80.0]}, "observe": "Qx", "noise": 0.05}
    >>> Fit(scene=ts.Scene.builtin("spheres"), free="friction.mu", data=[creep]).loss
    'linear'
    """

    title: str = entry("title", default="")
    scene: Scene = entry("the scene", "a built-in name, a scene file, or the tables of a scene")
    free: Names = entry(
        "numeric keys of the scene that are fitted", "a list of dotted keys", min_length=1
    )
    data: tuple[Data, ...] = entry("the data sets", "at least one [[fit.data]]", min_length=1)
    parameter: tuple[Parameter, ...] = entry("starts, bounds and priors", "a list of tables", ())
    test: tuple[CandidateTest, ...] = entry("candidates of the next test", "a list of tables", ())
    target: str | None = optional(
        "parameter with the uncertainty that the next test is to reduce; by default all together",
        "one of free",
    )
    loss: Literal["linear", "soft_l1", "huber", "cauchy", "arctan"] = entry(
        "loss of a residual; all but linear give less weight to outliers", default="linear"
    )
    starts: int = entry(
        "starts of the search; those beyond the first are random", default=1, ge=1, le=100
    )
    seed: int = entry("seed of random starts", "an integer from 0", 0, ge=0)
    intervals: Literal["linear", "profile"] = entry(
        "intervals by the linearised model, or by the profile likelihood", default="linear"
    )
    scatter: bool = entry("whether the scatter of the residuals scales the noise", default=False)
    level: float = entry("probability of the intervals", default=0.95, ge=0.5, le=0.999)
    step: float | None = optional(
        "step of differences over the value; by default 1e-4 of contacts and 1e-2 of rolls",
        gt=0,
        le=0.2,
    )
    iterations: int = entry("most iterations", default=50, ge=1, le=1000)
    curve: int = entry(
        "points of the model curve of each creep curve, for figures; 0: at measured points only",
        default=25,
        ge=0,
        le=200,
    )
    mesh_check: bool = entry(
        "whether the solution is computed on a finer mesh as well", default=True
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_parameters,
        _check_free_keys,
        _check_varied_keys,
        _check_target,
        _check_mesh,
    )

    def settings_of(self, key: str) -> Parameter:
        """Return the [[fit.parameter]] table of a free key; its default if there is none."""
        return next((table for table in self.parameter if table.key == key), Parameter(key=key))


class FitDesign(Document):
    """A fit file: the table [fit] with its data sets, parameters and tests.

    Raises
    ------
    FitError
        With every fault.

    Examples
    --------
    >>> creep = {"values": {"Qx": [80.0]}, "observe": "Qx", "noise": 0.05}
    >>> design = ts.FitDesign(fit={"scene": "spheres", "free": "friction.mu", "data": [creep]})
    >>> design.fit.free
    ('friction.mu',)
    """

    fit: Fit = entry("the fit")
    error_class: ClassVar[type[SceneError]] = FitError

    def __init__(self, /, **entries: Any) -> None:
        table = entries.get("fit")
        if isinstance(table, Mapping) and isinstance(table.get("scene"), str | Mapping):
            try:
                scene = table["scene"]
                inner_scene = Scene.from_name(scene) if isinstance(scene, str) else Scene(**scene)
            except SceneError as error:
                raise FitError(fault.under("fit.scene") for fault in error.faults) from None
            entries["fit"] = {**table, "scene": inner_scene}
        super().__init__(**entries)

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Put a folder before paths of data files and a scene file there; return the tables."""
        match tables:
            case {"fit": {"scene": str(name)} as fit} if (folder / name).is_file():
                fit["scene"] = str(folder / name)
            case {"fit": {"scene": dict(scene)}}:
                Scene.resolve_files(folder, scene)
        match tables:
            case {"fit": {"data": list(data)}}:
                for data_set in data:
                    match data_set:
                        case {"file": str(name)}:
                            data_set["file"] = str(folder / name)
        return tables
