"""What a status means, and what to try where it is not a solution."""

from tractive_sam.contact.mesh import as_asked, grown
from tractive_sam.contact.model import Model
from tractive_sam.results import Grid, Status
from tractive_sam.scene import FEWEST_ELEMENTS
from tractive_sam.solvers import Outcome


def message(status: Status, outcome: Outcome, model: Model, steepness: float = 0.0) -> str:
    """Explain how a solve ended; of a solution what else there is to say (`State.message`).

    Parameters
    ----------
    status : Status
        How it ended.
    outcome : Outcome
        What was reached.
    model : Model
        What was asked.
    steepness : float
        `Problem.steepness` there.
    """
    scene, solver = model.scene, model.scene.solver
    courses = {} if scene.transient is None else scene.transient.courses
    if status is Status.CONVERGED:
        text = ""
        if any(note.status is not Status.CONVERGED for note in outcome.trace):
            text += f", by way of {', '.join(map(str, outcome.trace))}"
        touching = outcome.pressure > 0.0
        if not touching.any():
            key = "transient.load.approach" if "load.approach" in courses else "load.approach"
            text += f"; the bodies do not touch: {key} is less than the gap between them"
        across = [
            int(touching.any(axis=1 - axis).sum()) for axis in (0, 1) if touching.shape[axis] > 1
        ]
        if 0 < min(across) < FEWEST_ELEMENTS:
            text += (
                f"; only {' x '.join(map(str, across))} elements are in contact: refine the mesh "
                "with grid.elements or lessen grid.half_length"
            )
        return text
    if status is Status.OFF_GRID:
        text = (
            f"the contact reaches the edge of the mesh, {_half_length(model.grid)} mm: enlarge it, "
            f"as by {as_asked(grown(model.grid))}"
        )
        if scene.body.infinitely_long and model.measured is not None:
            text += "; with radius_y = inf only a [gap] that rises towards its sides ends it in y"
        return text
    reached = (
        f"not converged: residual {outcome.residual:.1e} after {outcome.iterations} iterations "
        f"({', '.join(map(str, outcome.trace))}), asked for {solver.tolerance:.1e}; "
    )
    forces = [f"load.{key}" for key in ("force_x", "force_y") if getattr(scene.load, key)]
    forces += [f"transient.{key}" for key in courses if key.startswith("load.force")]
    if outcome.top is not None:
        return reached + _beyond_the_top(outcome.top, forces[0], model)
    if forces and outcome.status is Status.DIVERGED:
        return reached + (
            "the prescribed tangential force may be more than friction can carry beside the other "
            f"creepages and the spin: lower {' or '.join(forces)}, or raise friction.mu"
        )
    if steepness >= 1.0:
        return reached + too_steep(steepness)
    return reached + model.method.cure + (GENTLER if model.friction_law.falls else "")


GENTLER = (
    "; or friction falls too fast with sliding: a larger friction.memory or friction.half_speed, "
    "or with a friction.layer a coarser mesh, makes it gentler"
)


def too_steep(steepness: float) -> str:
    """What a friction law says that falls faster with sliding than the mesh can hold.

    Parameters
    ----------
    steepness : float
        `Problem.steepness`.
    """
    return (
        f"friction.law: friction falls {steepness:.2g} times as fast with sliding as an element "
        "gives way by itself, so several solutions may hold, and which is found hinges on the "
        'mesh; friction.start = "sliding" seeks another one. A larger friction.memory or '
        "friction.half_speed, or with a friction.layer a coarser mesh, makes it one"
    )


def _beyond_the_top(top: tuple[float, float], key: str, model: Model) -> str:
    force = top[0] * model.units.pressure * model.grid.element_area
    top_force = f"{force:.5g} {model.scene.force_unit}"
    return (
        f"{key} is beyond the top of the traction curve, {top_force} at a creepage of "
        f"{top[1] * model.units.slip:.3g}: friction falls with sliding, and no creepage gives "
        f"more; lower {key}, or give the creepage"
    )


def _half_length(grid: Grid) -> str:
    sides = zip(grid.half_length, grid.elements, strict=True)
    return " x ".join(f"{length:g}" for length, elements in sides if elements > 1)
