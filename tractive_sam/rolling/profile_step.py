"""Linearly implicit steps of the wear of two profiles.

The depths worn off both profiles, along their normals and over their arc lengths, follow

    dE/dN = sum over positions of w_j D_j R_j(I_j E)

with the share w_j of a position in the revolutions, the depth R_j that its patches wear in a pass,
the depths I_j E of both bodies together at the rows of a patch, and D_j, which brings a depth at
rows to nodes of the profiles. Short waves of a profile decay fast (`rolling.response`); the steps
are linearly implicit in the response J_j of R_j, so that they are not limited by stability:

    (1 - dN sum w_j D_j J_j I_j) dE = dN sum w_j D_j R_j.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.results import Grid, State

Depths = tuple[np.ndarray, np.ndarray]
"""Depths worn off the wheel and off the rail at the nodes of their profiles, mm."""


@dataclass(frozen=True, eq=False)
class PatchWear:
    """Wear rates of wheel and rail in one contact patch, and their response to the wear.

    Attributes
    ----------
    rates : ndarray, shape (2, n_y)
        Depth of wheel and rail at each row per revolution of the wheel, mm.
    response : ndarray, shape (n_y, n_y)
        Derivative of the depth of both with respect to the profile, 1/revolution.
    places : ndarray, shape (2, n_y)
        Arc lengths of the new wheel and of the new rail at the rows, mm.
    area : float
        Cross-section that a single pass wears off both, mm2; it is not stored.
    """

    rates: np.ndarray
    response: np.ndarray
    places: np.ndarray
    area: float = math.nan


@dataclass(frozen=True, eq=False)
class PositionWear:
    """Wear of wheel and rail at one lateral position of the wheelset, patch by patch.

    Attributes
    ----------
    share : float
        Share of the position in the revolutions.
    contact : State
        Contact of the patch with most load, or one that was not solved.
    start : State
        Contact of the first patch, from which the next step starts.
    worn : tuple of PatchWear
        Wear of each patch that touches.
    values : mapping of str to object
        Columns of the position that the contact alone does not determine.
    """

    share: float
    contact: State
    start: State
    worn: tuple[PatchWear, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Start contact and wear of each patch as arrays, by name, for `restore`."""
        start = self.start
        numbers = (*start.grid.half_length, start.approach)
        state = {
            "fields": np.stack((start.pressure, *start.traction)),
            "numbers": np.array(numbers),
        }
        for name in ("rates", "response", "places"):
            state[name] = np.stack([getattr(patch, name) for patch in self.worn])
        return state

    @classmethod
    def restore(
        cls, share: float, contact: State, state: Mapping[str, np.ndarray]
    ) -> "PositionWear":
        """Return the wear at a position from its stored arrays and its contact."""
        pressure, *traction = state["fields"]
        *half_length, approach = state["numbers"].tolist()
        grid = Grid((half_length[0], half_length[1]), pressure.shape)
        none = np.zeros(pressure.shape)
        start = replace(
            contact,
            **{"grid": grid, "pressure": pressure, "traction": np.stack(traction)},
            **{"slip": np.stack((none, none)), "gap": none, "wear": none, "approach": approach},
        )
        arrays = (state[name] for name in ("rates", "response", "places"))
        worn = tuple(PatchWear(*patch) for patch in zip(*arrays, strict=True))
        return cls(share, start, start, worn)


def implicit_step(
    worn: list[tuple[float, PatchWear]],
    nodes: tuple[np.ndarray, np.ndarray],
    longest: int,
    deepest: float,
) -> tuple[Depths, int]:
    """Return the added wear depths of both profiles, and the revolutions of an implicit step.

    Parameters
    ----------
    worn : list of (float, PatchWear)
        Share of the position, and wear of a patch in it.
    nodes : tuple of ndarray
        Arc lengths of the nodes of both profiles, mm.
    longest : int
        Largest number of revolutions.
    deepest : float
        Largest depth of wear, mm.
    """
    size = nodes[0].size
    onto = [_onto_nodes(patch, nodes) for _, patch in worn]
    each = [*zip(worn, onto, strict=True)]
    rate = sum(share * matrix @ patch.rates.sum(axis=0) for (share, patch), matrix in each)
    length = max(1, int(min(longest, deepest / max(float(rate.max()), 1e-300))))
    active = np.flatnonzero(rate > 0.0)
    system = np.eye(active.size)
    for (share, patch), matrix in each:
        pairs = zip(patch.places, nodes, strict=True)
        at_rows = np.concatenate([_interpolation(s, at) for at, s in pairs], axis=1)[:, active]
        system -= length * share * matrix[active] @ patch.response @ at_rows
    change = np.zeros(rate.size)
    change[active] = length * np.linalg.solve(system, rate[active])
    change = np.maximum(change, 0.0)
    return (change[:size], change[size:]), length


def _onto_nodes(patch: PatchWear, nodes: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Return the matrix from wear depths at rows of a patch to depths at profile nodes."""
    total = patch.rates.sum(axis=0)
    parts = patch.rates / np.where(total > 0.0, total, 1.0)
    triples = zip(patch.places, nodes, parts, strict=True)
    return np.concatenate([_interpolation(at, s) * part for at, s, part in triples])


def _interpolation(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the matrix of linear interpolation from `nodes` to `at`; zero beyond the nodes."""
    k = np.clip(np.searchsorted(nodes, at) - 1, 0, nodes.size - 2)
    share = (at - nodes[k]) / (nodes[k + 1] - nodes[k])
    matrix, rows = np.zeros((at.size, nodes.size)), np.arange(at.size)
    inside = (share >= 0.0) & (share <= 1.0)
    matrix[rows, k], matrix[rows, k + 1] = inside * (1.0 - share), inside * share
    return matrix
