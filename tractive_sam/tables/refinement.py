"""Settings of the refinement of a table, and its progress."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Refinement:
    """Settings of the adaptive refinement of a creep-force table.

    Attributes
    ----------
    full : float
        r over r_0 that is solved for full slip if it has no closed form: the share of stick is
        as small.
    samples : int
        Check points in the middle of every interval of every axis.
    anywhere : int
        Check points anywhere, at most as many as nodes. The points that led to a refinement say
        less about others: a table is complete only if as many new ones have small errors. If three
        in a thousand exceed `miss`, a thousand random points find one in 95 of 100 cases; these are
        distributed more evenly.
    miss : float
        Error over the tolerance from which a point anywhere leads to a refinement.
    worst : float
        The corresponding error over the largest one: nodes for the worst points often reduce
        smaller errors.
    checks : int
        Final check points anywhere, which measure the errors; at most as many as nodes.
    rounds : int
        Largest number of refinements.
    step : float
        Step of differences of closed forms along heading and tilt.
    first_u : tuple of float
        First nodes along u: closest at the onset of full slip, at which forces change abruptly.
    """

    full: float = 1e4
    samples: int = 5
    anywhere: int = 1000
    miss: float = 0.5
    worst: float = 0.5
    checks: int = 200
    rounds: int = 24
    step: float = 1e-4
    first_u: tuple[float, ...] = (0.0, 0.2, 0.4, 0.475, 0.55, 0.625, 0.7, 0.85, 1.0)

    @property
    def last_u(self) -> float:
        """Largest scaled creepage u that is solved to stand for full slip."""
        return self.full / (1.0 + self.full)


@dataclass(frozen=True)
class TableProgress:
    """Progress of the construction of a table: nodes, solved nodes, refinements.

    Attributes
    ----------
    nodes, done : int
        Number of nodes of the present grid, and of those that are solved.
    round : int
        Number of refinements.
    """

    nodes: int
    done: int
    round: int
