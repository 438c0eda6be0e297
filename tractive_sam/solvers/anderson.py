"""Anderson acceleration of the projected iterations."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tractive_sam.solvers.projection import ProjectedMap, Projection, States


@dataclass(frozen=True)
class Anderson(Projection):
    """Anderson acceleration of the projected iteration: the last images are combined.

    Anderson (1965), J. ACM 12, 547-560; Walker & Ni (2011), SIAM J. Numer. Anal. 49, 1715-1735.

    A state that makes the residual ten times the best one so far restarts the memory from the
    best state.

    Attributes
    ----------
    step_factor : float
        Step of the slip over its bound; acceleration tolerates and profits from longer ones than
        Uzawa's method.
    memory : int
        Images that are combined with the last one.
    iterations : int
        Most iterations.
    """

    step_factor: float = 16.0
    memory: int = 12
    iterations: int = 5_000

    name: ClassVar[str] = "anderson"

    def _states(self, mapping: ProjectedMap, state: np.ndarray) -> States:
        """Yield (map, state) to evaluate, each state combined from the last images."""
        images: list[np.ndarray] = []
        changes: list[np.ndarray] = []
        best, smallest = state, np.inf
        while True:
            evaluation = yield mapping, state
            if not np.isfinite(evaluation.residual) or evaluation.residual > 10.0 * smallest:
                if not images:
                    return
                images, changes = [], []
                state, smallest = best, np.inf
                continue
            if evaluation.residual < smallest:
                best, smallest = state, evaluation.residual
            images.append(evaluation.image)
            changes.append(evaluation.image - state)
            del images[: -self.memory - 1], changes[: -self.memory - 1]
            state = mapping.admissible(combine_images(images, changes))


def combine_images(images: Sequence[np.ndarray], changes: Sequence[np.ndarray]) -> np.ndarray:
    """Return the affine combination of images for which the combined change is smallest."""
    if len(images) == 1:
        return images[0]
    differences = np.stack([(changes[-1] - c).ravel() for c in changes[:-1]])
    gram = differences @ differences.T
    weights = np.linalg.lstsq(gram, differences @ changes[-1].ravel(), rcond=1e-14)[0]
    return images[-1] - sum(
        w * (images[-1] - image) for w, image in zip(weights, images[:-1], strict=True)
    )
