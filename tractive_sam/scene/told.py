"""What a scene asks, told in the units that people have beside those of its keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .duty import label
from .faults import MOST_TOLD
from .wear import BY_COEFFICIENT, OF_SETS, PER_INTENSITY, Coefficients

if TYPE_CHECKING:
    from .scene import Scene


def told(scene: Scene) -> dict[str, str]:
    """The load and the wear of a scene, whose they are, and what N counts, by what is told."""
    rows = {"load": load_told(scene)}
    if scene.wear is not None:
        rows |= {"wear": wear_told(scene), "of the depth": share_told(scene)}
        if scene.transient is None:
            rows["turns"] = turns_told(scene)
        rows["worn mass"] = density_told(scene)
    return rows | duty_told(scene)


def duty_told(scene: Scene) -> dict[str, str]:
    """What each block of a duty cycle changes, and its part of the revolutions."""
    rows = {} if scene.load_history is None else {"load history": _binned_told(scene)}
    for k, block in enumerate(scene.duty[:MOST_TOLD]):
        changes = [f"{key} = {_value(value)}" for key, value in block.changes.items()]
        changes += [f"shift_y = {block.shift_y:g} mm"] if block.shift_y else []
        share = f"{block.revolutions} of {scene.spectrum.cycle} revolutions"
        rows[label(scene, k)] = f"{share}: {', '.join(changes) or 'as the scene says'}"
    if len(scene.duty) > MOST_TOLD:
        rows["other blocks"] = f"{len(scene.duty) - MOST_TOLD} more"
    return rows


def _binned_told(scene: Scene) -> str:
    """What levels made of a measured load history, and how far they are off it."""
    history = scene.load_history
    off = ", ".join(f"{name} by {error:.2%}" for name, error in history.error.items() if error)
    rows = (
        f"{history.rows} rows of {history.file.name} in {len(scene.duty)} blocks by "
        f"{history.levels} levels of each column; off their block, root mean square of the "
        f"largest: {off or 'nothing'}"
    )
    if history.work_error is None:
        return rows
    return f"{rows}; load x creepage by {history.work_error:.2%}"


def _value(value: float | tuple[float, float]) -> str:
    return _pair(*value) if isinstance(value, tuple) else f"{value:g}"


def load_told(scene: Scene) -> str:
    """The load and the peak pressure that it makes, whichever of them is given."""
    hertz, load, unit = scene.hertz, scene.normal_load, scene.force_unit
    if hertz is None:
        if load is None:
            return f"approach = {scene.load.approach:g} mm"
        return f"P = {load:g} {unit}"
    if scene.load.approach is not None:
        given = f"approach = {scene.load.approach:g} mm"
        return f"{given}: P = {hertz.load:.6g} {unit} and p0 = {hertz.p0:.6g} MPa by Hertz, unworn"
    if scene.load.pressure is not None:
        return f"p0 = {hertz.p0:g} MPa by Hertz, unworn: P = {load:.6g} {unit}"
    return f"P = {load:g} {unit}: p0 = {hertz.p0:.6g} MPa by Hertz, unworn"


def friction_told(scene: Scene) -> str:
    """The law of friction, and all that it depends on."""
    friction = scene.friction
    mu1, mu2 = friction.mu
    words = f"isotropic, mu = {mu1:g}"
    if mu1 != mu2:
        words = f"orthotropic, mu = ({mu1:g}, {mu2:g}) at {friction.angle:g} degrees"
    if friction.share is not None:
        least, half = friction.share
        words += (
            f" at rest, falls to {_pair(least * mu1, least * mu2)}, {friction.law}, half of the "
            f"way at {half:g} mm/s of sliding"
        )
        if friction.memory:
            words += f", after {friction.memory:g} mm slid"
        words += f"; followed from {'great speed' if friction.start == 'sliding' else 'rest'}"
    if friction.named_law:
        words += f", by the law {friction.named_law}"
    words += _factors_told(friction.temperature)
    if friction.strength is not None:
        words += f"; no more than {friction.strength:g} MPa"
    if friction.layer:
        words += f"; through a layer of h/G3 = {friction.layer:.4g} mm/MPa"
    return words


def wear_told(scene: Scene) -> str:
    """The law of wear with its coefficients, whose they are, and what heat makes of it."""
    if scene.wear.named_law:
        return f"{scene.wear.named_law}{_factors_told(scene.wear.temperature)}"
    return _coefficients_told(scene) + _factors_told(scene.wear.temperature)


def _factors_told(factors: tuple[tuple[float, float], ...] | None) -> str:
    """Factors over the temperature, from the first to the last."""
    if factors is None:
        return ""
    least, most = factors[0], factors[-1]
    ends = f"times {least[1]:g} at {least[0]:g} degC to {most[1]:g} at {most[0]:g} degC"
    return f"; {ends} of the surface"


def _coefficients_told(scene: Scene) -> str:
    wear = scene.wear
    if not wear.together:
        of_A, of_B = (_of_body(scene, body) for body in "AB")
        return f"A and B: {of_A}" if of_A == of_B else f"A: {of_A}; B: {of_B}"
    i1, i2 = wear.intensities
    k = wear.coefficient
    rate = _pair(PER_INTENSITY * i1, PER_INTENSITY * i2)
    unit = "mm3/J" if wear.law == "energy" else "mm3/(N m)"
    both = f"k = {rate} {unit}"
    if wear.law == "archard":
        both = f"i = {_pair(i1, i2)} /MPa, {both}"
    if isinstance(k, Coefficients):
        return f"k = {k.A:g} {unit} of body A and {k.B:g} of B; of both together {both}"
    return f"{both}, of both bodies together"


def law_told(scene: Scene) -> str:
    """What the law of wear goes by."""
    if scene.wear.named_law:
        return "of another package"
    if scene.wear.law == "energy":
        return "by the work of friction"
    if scene.wear.law == "archard":
        upwind = scene.solver.slip == "upwind"
        return f"Holm-Archard by {'pressure and slip' if upwind else 'the work of friction'}"
    return "each body by its own"


def _of_body(scene: Scene, body: str) -> str:
    """The law of one body."""
    wear = scene.wear
    law, chosen = wear.laws[body], wear.sets[body]
    if law in BY_COEFFICIENT:
        k = f"k = {getattr(wear.coefficient, body):g}"
        return f"Holm-Archard, {k} mm3/(N m)" if law == "archard" else f"by work, {k} mm3/J"
    if law == "table":
        return f"T-gamma/A of each {wear.by}, a table of {len(wear.law.table)} points"
    if law is None:
        return "does not wear"
    goes_by = {"usfd": f"T-gamma/A of each {wear.by}", "brr": "T-gamma of each contact"}
    sets = OF_SETS[law]
    source = sets[chosen][1] if law == "jendel" else sets[chosen].source
    return f"{goes_by.get(law, 'sliding speed and p/H')}, {chosen}: {source}"


def share_told(scene: Scene) -> str:
    """Which part of the worn depth each body has, and why."""
    if not scene.wear.together:
        return "each body by its own law"
    share, hard = scene.wear_share, scene.body
    why = "no hardness is given"
    if scene.wear.share is not None:
        why = "by their coefficients"
    elif "hardness" in hard.A.model_fields_set:
        why = f"inverse to their hardness, {hard.A.hardness:g} and {hard.B.hardness:g}"
    return f"{share['A']:.3g} from body A, {share['B']:.3g} from B: {why}"


def turns_told(scene: Scene) -> str:
    """What N counts, and what each body meets again."""
    if scene.wear.turns == "equal":
        return "equal: N counts those of body A, and what both wore comes round as one"
    turns = scene.turns.per_count
    counted, other = "AB" if turns["A"] else "BA"
    told = f"N counts those of body {counted}"
    if turns[other] == 0.0:
        return (
            f"{told}; {other} is flat and never comes round: it enters unworn, and its depth is "
            "that of a single pass"
        )
    return (
        f"{told}, {other} turns {turns[other]:.6g} times in each; each meets its own wear again, "
        "averaged over the phase, with no slip counted"
    )


def density_told(scene: Scene) -> str:
    """The densities that turn worn volume into mass, and whether they are only assumed."""
    words = []
    for name in "AB":
        body = getattr(scene.body, name)
        given = "" if "density" in body.model_fields_set else " (of steel, not given)"
        words.append(f"{name} {body.density:g} kg/m3{given}")
    return ", ".join(words)


def _pair(first: float, second: float) -> str:
    return f"{first:g}" if first == second else f"({first:g}, {second:g})"
