"""The slip stencil: where the slip of an element is taken, and all that follows from it.

Tractions belong to the centres of the elements, -du/dx by the difference of two neighbouring
centres to the face between them: the leading face of the one element and the trailing face of the
other. Both schemes let an element answer for its **leading** face, so that every row is determined
from its leading edge on, as the material that enters there unstressed asks for, and odd-even waves
of the traction are damped. They differ in what makes the error of first or of second order:

================  =====================================  =======================================
                  `UPWIND`, the paper's                  `STAGGERED`
================  =====================================  =======================================
rigid slip        at the centre                          at the face, like the elastic one
leading elements  stick where the face ahead of them,    stick where that face slips by as much
                  out of contact, does not slip          as the surfaces part there
traction opposes  the slip of the leading face           the slip at the centre, between the faces
wear, work        by the slip of the leading face        by the mean slip of both faces
================  =====================================  =======================================

**Why it is of second order.** Of a smooth traction of wave number k the difference of the exact
displacements of its elements gives the slip at the face up to a relative error of order (k dx)².
So it is the points compared with each other, and the edges, that cost an order. *Leading edge*:
there traction and pressure rise like the root of the distance, and the traction is a smooth share
of its bound. The pressure of the normal problem makes the displacements of neighbouring centres
differ smoothly as long as both are in contact, but that of the first centre ahead by the gap there;
a traction of constant share of it does likewise. So where the leading element sticks, the face
ahead of it slips by -share x gap/dx. To ask for this lets the traction learn from the pressure
where within its element the edge lies, to second order; with no slip asked for there the contact is
about half an element too long. *Border of stick and slip*: it is free, and forces do not answer a
small shift of it to first order. *Trailing edge in slip*: there the traction is the bound.

Between dissimilar bodies the share changes with the logarithm of the distance from the edge, and
the leading edge remains of first order.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stencil:
    """A way to take the slip; see the module.

    Attributes
    ----------
    staggered : bool
        Whether points and edges are treated to second order.
    """

    staggered: bool

    @property
    def rigid_ahead(self) -> float:
        """Distance ahead of the centre at which the rigid slip is taken, in elements."""
        return 0.5 if self.staggered else 0.0

    def at_centres(self, slip: np.ndarray) -> np.ndarray:
        """The slip that wears and dissipates, from that of the leading faces.

        By the mean of both faces frictional work and energy law agree to rounding: the elastic part
        of it is a central difference, whose work on the tractions is zero by antisymmetry.

        Parameters
        ----------
        slip : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces; the elements at index 0 keep it.
        """
        if not self.staggered:
            return slip
        mean = slip.copy()
        mean[:, 1:] = 0.5 * (slip[:, 1:] + slip[:, :-1])
        return mean

    def leading(self, bound: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices (i, j) of the elements ahead of which the surfaces part; none for `UPWIND`.

        Parameters
        ----------
        bound, gap : ndarray, shape (n_x, n_y)
            Pressure, zero out of contact, and gap.
        """
        leading = np.zeros(bound.shape, bool)
        if self.staggered:
            leading[:-1] = (bound[:-1] > 0.0) & (bound[1:] <= 0.0) & (gap[1:] > 0.0)
        return np.nonzero(leading)


def edge_normals(bound: np.ndarray, i: np.ndarray, j: np.ndarray, aspect: float) -> np.ndarray:
    """Unit vectors out of the contact at leading elements (i, j), shape (2, m).

    Down the gradient of the squared pressure, which falls linearly to a smooth edge. Where the
    pressure does not fall towards the edge, as if it fell a little: so it stays continuous.

    Parameters
    ----------
    bound : ndarray, shape (n_x, n_y)
        Pressure.
    i, j : ndarray of int, shape (m,)
        Indices of the elements.
    aspect : float
        dx/dy.
    """
    square = np.pad(bound**2, 1)
    i, j = i + 1, j + 1
    fall = np.maximum(square[i - 1, j] - square[i, j], 0.1 * square[i, j])
    aside = 0.5 * aspect * (square[i - 1, j - 1] - square[i - 1, j + 1])
    angle = np.arctan2(aside, fall)
    return np.stack((np.cos(angle), np.sin(angle)))


class FrictionSlip:
    """The slip that the friction law sees, from that of the leading faces, under a pressure.

    Parameters
    ----------
    staggered : bool
        As of `Stencil`; if not, the slip of the leading faces is returned as it is.
    bound, gap : ndarray, shape (n_x, n_y)
        Pressure and gap.
    leading : tuple of ndarray of int, shape (m,)
        Indices (i, j) of the leading elements.
    opening : ndarray, shape (m, 2, 2)
        What the face ahead slips by a unit of gap there, over the share of the bound.
    """

    def __init__(self, staggered, bound, gap, leading, opening):
        self.staggered = staggered
        self.bound = bound
        self._here, self._ahead = leading, (leading[0] + 1, leading[1])
        self._opening = opening
        # A thousandth of a billionth of the pressure bears no traction that matters.
        self._bound = np.maximum(bound[self._here], 1e-12 * bound.max(initial=0.0))
        self._gap = gap[self._ahead]
        self._stiffness = np.trace(opening, axis1=1, axis2=2) * self._gap / self._bound

    def sticking(self, slip: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """What must vanish where an element sticks, linear in slip and traction.

        The slip of the leading face, less what the opening ahead of a leading element accounts
        for. There it is divided by 1 + `stiffness`, so that it answers the traction no more than
        one to one, however little the element bears.

        Parameters
        ----------
        slip, traction : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces, and the tractions it goes with.
        """
        if not self._gap.size:
            return slip
        return self._with_opening(slip, self._gap * traction[:, *self._here] / self._bound)

    def sticking_change(
        self, slip: np.ndarray, traction: np.ndarray, change: np.ndarray, gap: np.ndarray
    ) -> np.ndarray:
        """Change of `sticking` where pressure and gap change as well.

        Parameters
        ----------
        slip : ndarray, shape (2, n_x, n_y)
            Change of the slip of the leading faces.
        traction : ndarray, shape (2, n_x, n_y)
            Tractions at which the change is taken.
        change : ndarray, shape (3, n_x, n_y)
            Change of pressure and tractions.
        gap : ndarray, shape (n_x, n_y)
            Change of the gap.
        """
        if not self._gap.size:
            return slip
        share = traction[:, *self._here] / self._bound
        shifted = (change[1:, *self._here] - share * change[0][self._here]) / self._bound
        return self._with_opening(slip, self._gap * shifted + share * gap[self._ahead])

    def _with_opening(self, slip: np.ndarray, times_gap: np.ndarray) -> np.ndarray:
        opening = np.einsum("mab,bm->am", self._opening, times_gap)
        slip = slip.copy()
        slip[:, *self._here] = (slip[:, *self._here] + opening) / (1.0 + self._stiffness)
        return slip

    @property
    def stiffness(self) -> np.ndarray:
        """Bound on the part of `sticking` that answers the traction of the element itself.

        Before the division; shape (n_x, n_y), zero but in leading elements.
        """
        field = np.zeros(self.bound.shape)
        field[self._here] = self._stiffness
        return field


UPWIND = Stencil(staggered=False)
"""The paper's, eq. (28), of first order."""

STAGGERED = Stencil(staggered=True)
"""Of second order."""
