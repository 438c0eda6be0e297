"""Error bars of the gradients of a table, from contacts that are held out."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.lookup import Coordinates, CreepTable, cell_of, share_of_bar


@dataclass(frozen=True, eq=False)
class GradientChecks:
    """Solved gradients at check points, with which a table is compared.

    Attributes
    ----------
    points : ndarray, shape (P, N)
        Points along the axes of the table.
    w : ndarray, shape (P, 3)
        Scaled creepages of the points.
    ratio : ndarray, shape (P,)
        Values of a/b of the points.
    gradients : ndarray, shape (P, 3, 3)
        Derivatives of scaled forces by scaled creepages there.
    bars : ndarray, shape (P, 3, 3)
        Error bars of these derivatives.
    """

    points: np.ndarray
    w: np.ndarray
    ratio: np.ndarray
    gradients: np.ndarray
    bars: np.ndarray

    def errors(self, table: CreepTable) -> np.ndarray:
        """Return errors of a table's gradients (>= their bars) over slopes at rest, (P, 3, 3)."""
        where = Coordinates.of(self.w.T, self.ratio, table.whole)
        points = (*self.points.T[: len(table.names)], *where.points)
        gradients = np.moveaxis(table.gradient_at(points, where), -1, 0)
        size = np.sqrt(table.slopes_at_rest(points, where.r0)).T
        errors = np.maximum(np.abs(gradients - self.gradients), self.bars)
        return errors / (size[:, :, None] * size[:, None, :])


@dataclass(frozen=True, eq=False)
class GradientBars:
    """Error bars of a table's gradients by interval of u, with statistics of their checks.

    Attributes
    ----------
    values : ndarray, shape (n_u, 3, 3)
        Error bars at rest, and within each interval of u.
    about : dict
        Number of checks, their median and largest error, the largest one at rest, and the share of
        checks within the bars.
    """

    values: np.ndarray
    about: dict[str, float]

    @classmethod
    def from_errors(
        cls,
        nodes: np.ndarray,
        u: np.ndarray,
        errors: np.ndarray,
        at_rest: np.ndarray,
        *,
        inside: float = 0.98,
        shared: float = 0.05,
    ) -> "GradientBars":
        """Return error bars that cover the share `inside` of the errors at check points.

        Each check is compared with the bars of the others. At rest contacts are solved on many
        meshes, and the bar is the largest error.

        Parameters
        ----------
        nodes : ndarray, shape (n_u,)
            Nodes along u.
        u : ndarray, shape (P,)
            Values of u of the checks; several in each interval.
        errors : ndarray, shape (P, 3, 3)
            Errors of the checks.
        at_rest : ndarray, shape (R, 3, 3)
            Errors at rest.
        inside : float
            Share of the checks within the bars: more than the required 95 of 100 new points, as
            the share scatters.
        shared : float
            Smallest bar of a derivative, over the largest of the nine.
        """
        cells, rest = cell_of(nodes, u), at_rest.max(axis=0)
        count = np.bincount(cells, minlength=len(nodes) - 1)
        sums = np.zeros((len(nodes) - 1, 3, 3))
        np.add.at(sums, cells, errors**2)
        without = (sums[cells] - errors**2) / np.maximum(count[cells] - 1, 1)[:, None, None]
        beyond = np.maximum(errors - rest, 0.0) / _spread(without, shared)
        shares = beyond.max(axis=(1, 2)) / share_of_bar(nodes, u)
        factor = max(1.0, float(np.quantile(shares, inside)))
        bars = factor * _spread(sums / np.maximum(count, 1)[:, None, None], shared)
        worst = errors.max(axis=(1, 2))
        about = {
            "gradient_checks": len(errors),
            "gradient_median": float(np.median(worst)),
            "gradient_worst": float(worst.max()),
            "gradient_at_rest": float(rest.max()),
            "gradient_inside": float(np.mean(shares <= factor)),
        }
        return cls(np.concatenate([rest[None], bars]), about)


def _spread(squares: np.ndarray, shared: float) -> np.ndarray:
    """Return square roots of mean squares (..., 3, 3), at least a share of the largest."""
    roots = np.sqrt(squares)
    return np.maximum(roots, shared * roots.max(axis=(-2, -1), keepdims=True) + 1e-12)
