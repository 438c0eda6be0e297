"""Anderson acceleration of the projected iterations."""

import numpy as np

from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.fixed_point import CoupledMap, TangentialMap
from tractive_sam.solvers.outcome import Outcome

MEMORY = 12
ITERATIONS = 5_000


def anderson(
    mapping: TangentialMap | CoupledMap,
    tolerance: float,
    start: np.ndarray,
    memory: int = MEMORY,
    iterations: int = ITERATIONS,
) -> Outcome:
    """Combine the last images so that their combined change is least.

    Anderson (1965), J. ACM 12, 547-560; Walker & Ni (2011), SIAM J. Numer. Anal. 49, 1715-1735.

    A state that makes the residual ten times the best one so far starts the memory anew from the
    best state.
    """
    before = mapping.applications
    state = mapping.admissible(start)
    images: list[np.ndarray] = []
    changes: list[np.ndarray] = []
    best, best_residual = state, np.inf
    status = Status.OUT_OF_ITERATIONS
    taken = 0
    for taken in range(iterations + 1):
        now = mapping(state)
        if now.residual <= tolerance:
            status = Status.CONVERGED
            break
        if taken == iterations:
            break
        if not np.isfinite(now.residual) or now.residual > 10.0 * best_residual:
            if not images:
                status = Status.DIVERGED
                break
            images, changes = [], []
            state = best
            best_residual = np.inf
            continue
        if now.residual < best_residual:
            best, best_residual = state, now.residual
        images.append(now.image.ravel())
        changes.append((now.image - state).ravel())
        del images[: -memory - 1], changes[: -memory - 1]
        state = mapping.admissible(_combined(images, changes).reshape(state.shape))
    cost = Cost(mapping.applications - before)
    return Outcome(status, now.residual, taken, cost, **now.fields)


def _combined(images: list[np.ndarray], changes: list[np.ndarray]) -> np.ndarray:
    """Affine combination of the images whose combined change has the least norm."""
    if len(images) == 1:
        return images[0]
    differences = np.stack([changes[-1] - c for c in changes[:-1]])
    gram = differences @ differences.T
    weights = np.linalg.lstsq(gram, differences @ changes[-1], rcond=1e-14)[0]
    return images[-1] - sum(
        w * (images[-1] - image) for w, image in zip(weights, images[:-1], strict=True)
    )
