"""Describe the course of wear: its steps, the turns of the bodies, and their densities."""

from collections.abc import Mapping
from typing import Any


def describe_stepping(wear: Any, scene: Any) -> str:
    """Describe how [wear] proceeds: each revolution, adaptive jumps, or stored ones only."""
    if wear.stepping == "every-revolution":
        return "one by one"
    if wear.stepping == "saved":
        return f"in {len(wear.save)} jumps, without control of their error"
    if scene.has("wheel"):
        depth = f" of at most {wear.step_depth:g} mm" if wear.step_depth else ""
        return f"in adaptive steps{depth}, with an error of {wear.tolerance:g} of the wear depth"
    return (
        f"in adaptive jumps, with an error of {wear.tolerance:g} of the wear depth; "
        "the residual of their contacts is at most this value"
    )


def describe_turns(counting: str, turns: Mapping[str, float]) -> str:
    """Describe which revolutions N counts, and when worn material returns to the contact.

    Parameters
    ----------
    counting : str
        The key wear.turns.
    turns : mapping of str to float
        Turns of "A" and "B" per counted revolution.
    """
    if counting == "equal":
        return "equal: N counts the revolutions of body A; both bodies turn once in each"
    counted, second = "AB" if turns["A"] else "BA"
    count = f"N counts the revolutions of body {counted}"
    if turns[second] == 0.0:
        return (
            f"{count}; {second} is flat and passes the contact only once: it enters unworn, and "
            "its depth is the wear of a single pass"
        )
    times = "once" if turns[second] == 1.0 else f"{turns[second]:.6g} times"
    return (
        f"{count}; {second} turns {times} in each. Worn material returns after a turn of its body, "
        "averaged over the phase; slip is not counted"
    )


def describe_densities(bodies: Any) -> str:
    """Describe the densities that turn worn volume into mass, and whether they are assumed."""
    densities = []
    for name in "AB":
        body = getattr(bodies, name)
        origin = "" if "density" in body.model_fields_set else " (steel, by default)"
        densities.append(f"{name} {body.density:g} kg/m3{origin}")
    return ", ".join(densities)
