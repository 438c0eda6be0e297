"""The slip stencil: the place in an element at which slip is taken, and what follows from it.

Tractions belong to the centres of the elements, -du/dx by the difference of two neighbouring
centres to the face between them: the leading face of the one element and the trailing face of the
other. Both schemes let an element answer for its **leading** face, so that every row is determined
from its leading edge on, as the unstressed material that enters there requires, and odd-even waves
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
differ smoothly as long as both are in contact; the displacement of the first centre ahead differs
by the gap there. A traction that is a constant share of the pressure causes that share of the jump.
So if the leading element sticks, the face ahead of it slips by -share x gap/dx. By this condition
the traction takes the position of the edge within its element from the pressure, to second order;
with zero slip there the contact would be about half an element too long. *Border of stick and
slip*: it is free, and a small shift of it does not change forces to first order. *Trailing edge in
slip*: there the traction is the bound.

Pressure alone causes such a jump on crystals without symmetry (`Elasticity.opening`). Between
dissimilar bodies the share changes with the logarithm of the distance from the edge, and
the leading edge remains of first order.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.compute import Mirror, Places, backend_of

FARTHEST = 1e3
"""Largest ratio of `entry_beyond`: an edge so near a centre is as good as on it."""


@dataclass(frozen=True)
class Stencil:
    """Discretisation of slip: at leading faces of elements (upwind), or staggered, second order.

    Attributes
    ----------
    staggered : bool
        Whether points and edges are treated to second order.
    """

    staggered: bool

    @property
    def rigid_ahead(self) -> float:
        """Distance of the rigid slip ahead of the centre, elements: 0.5 if staggered, else 0."""
        return 0.5 if self.staggered else 0.0

    def at_centres(self, slip: np.ndarray) -> np.ndarray:
        """Return slip at centres: the mean of both faces if staggered; unchanged if upwind.

        With the mean of both faces frictional work and energy law agree to rounding: the elastic
        part of the mean is a central difference, and its work on the tractions is zero by
        antisymmetry.

        Parameters
        ----------
        slip : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces; elements at index 0 have no face behind and retain it.
        """
        if not self.staggered:
            return slip
        mean = slip.copy()
        mean[:, 1:] = 0.5 * (slip[:, 1:] + slip[:, :-1])
        return mean

    def leading(self, bound: np.ndarray, gap: np.ndarray) -> Places:
        """Return (i, j) of contact elements with an open gap at the next in +x; none for upwind.

        Parameters
        ----------
        bound, gap : ndarray, shape (n_x, n_y)
            Pressure, zero out of contact, and gap.
        """
        to_numpy = backend_of(bound).to_numpy
        bound, gap = to_numpy(bound), to_numpy(gap)
        leading = np.zeros(bound.shape, bool)
        if self.staggered:
            leading[:-1] = (bound[:-1] > 0.0) & (bound[1:] <= 0.0) & (gap[1:] > 0.0)
        i, j = np.nonzero(leading)
        return i, j


def edge_angles(
    bound: np.ndarray, i: np.ndarray, j: np.ndarray, aspect: float, mirror: Mirror | None = None
) -> np.ndarray:
    """Return the angles from x of the outward normals at leading elements (i, j), shape (m,).

    The normal points down the gradient of the squared pressure, which falls linearly to a smooth
    edge. A pressure that does not fall towards the edge counts as falling a little, so that the
    angle stays continuous.

    Parameters
    ----------
    bound : ndarray, shape (n_x, n_y)
        Pressure.
    i, j : ndarray of int, shape (m,)
        Indices of the elements.
    aspect : float
        dx/dy.
    mirror : Mirror, optional
        Symmetry of the pressure, if it is given on the upper half of its mesh.
    """
    here, behind, left, right = _neighbour_values(bound, i, j, mirror) ** 2
    return np.arctan2(0.5 * aspect * (left - right), np.maximum(behind - here, 0.1 * here))


def edge_turning(
    bound: np.ndarray, change: np.ndarray, i: np.ndarray, j: np.ndarray, aspect: float
) -> np.ndarray:
    """Return the first-order change of `edge_angles`, rad, for a change of pressure, (m,)."""

    def aside_and_fall(here, behind, left, right):
        return 0.5 * aspect * (left - right), np.where(falls, behind - here, 0.1 * here)

    pressure = _neighbour_values(bound, i, j)
    squares = pressure**2
    falls = squares[1] > 1.1 * squares[0]
    aside, fall = aside_and_fall(*squares)
    # d(p²) = 2 p dp, d arctan2(a, f) = (f da - a df)/(f² + a²).
    moving, falling = aside_and_fall(*(2.0 * pressure * _neighbour_values(change, i, j)))
    return (fall * moving - aside * falling) / (fall**2 + aside**2)


def entry_beyond(bound: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return (contact edge to centre ahead)/(edge to leading centre), distances; 0 to 1000.

    At the edge the squared pressure, linear from the element behind on, is zero.
    """
    here, behind, _, _ = _neighbour_values(bound, i, j) ** 2
    # Zero lies t = here/(behind - here) elements ahead of the centre, so that it is (1 - t)/t.
    return np.clip(behind / here - 2.0, 0.0, FARTHEST)


def entry_change(bound: np.ndarray, change: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return the first-order change of `entry_beyond` for one of pressure, (m,); 0 if clipped."""
    here, behind, _, _ = _neighbour_values(bound, i, j)
    ratio = behind / here
    changed, changed_behind, _, _ = _neighbour_values(change, i, j)
    inside = (ratio**2 > 2.0) & (ratio**2 < 2.0 + FARTHEST)
    return np.where(inside, 2.0 * ratio * (changed_behind - ratio * changed) / here, 0.0)


def _neighbour_values(
    field: np.ndarray, i: np.ndarray, j: np.ndarray, mirror: Mirror | None = None
) -> np.ndarray:
    """Return a field (4, m) at (i, j), behind, and behind to left and right; 0 off the mesh."""
    rows, columns = np.add(i, [[0], [-1], [-1], [-1]]), np.add(j, [[0], [0], [-1], [1]])
    if mirror is not None:
        columns = np.where(columns < 0, -mirror.between - columns, columns)
    width = field.shape[1]
    inside = (rows >= 0) & (columns >= 0) & (columns < width)
    return np.where(inside, field[rows, columns % width], 0.0)


class FrictionSlip:
    """Correction of the slip in the friction law for elements at the leading edge of contact.

    Parameters
    ----------
    staggered : float
        Distance of the faces ahead of the centres to which the slip is turned back, in half
        elements; 0, of `UPWIND`: the slip is not turned.
    bound, gap : ndarray, shape (n_x, n_y)
        Pressure and gap.
    leading, parted : tuple of ndarray of int, shape (m,)
        Indices (i, j) of the leading elements, and of those at which `gap` determines how far the
        surfaces part ahead of them.
    aspect : float
        dx/dy.
    opening : callable
        Slip of the face ahead per unit of gap there, over the share of the bound, as a function of
        the angle of an edge, shape (m,) to (m, 2, 2); with a third column, the slip that pressure
        without traction causes there, per unit of gap.
    layer : ndarray, shape (2, 2), optional
        Slip of an interfacial layer over an element per unit of the traction gained there.
    gap_changes : bool
        Whether the gap changes with the tractions sought; a step uses the gap before it.
    mirror : Mirror, optional
        See `edge_angles`.
    """

    def __init__(
        self,
        staggered: float,
        bound: np.ndarray,
        gap: np.ndarray,
        leading: Places,
        parted: Places,
        aspect: float,
        opening: Callable[[np.ndarray], np.ndarray],
        layer: np.ndarray | None = None,
        gap_changes: bool = True,
        mirror: Mirror | None = None,
    ):
        self._gap_changes = gap_changes
        self.staggered = staggered
        self.bound, self.gap = bound, gap
        to_numpy = backend_of(bound).to_numpy
        bound, gap = to_numpy(bound), to_numpy(gap)
        self._here, self._ahead = leading, parted
        self._aspect, self._opening_at = aspect, opening
        self._angle = edge_angles(bound, leading[0], leading[1], aspect, mirror)
        self._opening = opening(self._angle)
        # Divided by: elements below 1e-12 of the peak pressure carry no traction that matters.
        self._bound = np.maximum(bound[self._here], 1e-12 * bound.max(initial=0.0))
        self._gap = gap[self._ahead]
        self._opened = np.trace(self._opening, axis1=1, axis2=2) * self._gap / self._bound
        self._stiffness, self._layer = self._opened, layer
        if layer is not None:
            self._entry = entry_beyond(bound, *leading)
            self._stiffness = self._opened + self._entry * np.trace(layer)

    @cached_property
    def _opening_by_angle(self) -> np.ndarray:
        """Derivative of the slip per unit of gap with respect to the angle of the edge."""
        h = 1e-4
        return (self._opening_at(self._angle + h) - self._opening_at(self._angle - h)) / (2.0 * h)

    def sticking(self, slip: np.ndarray, traction: np.ndarray, pressure: float = 1.0) -> np.ndarray:
        """Return the slip, corrected at leading elements, that vanishes where elements stick.

        The slip of the leading face, less what the opening ahead of a leading element accounts
        for. There it is divided by 1 + `stiffness`, so that it answers the traction no more than
        one to one, however little the element carries.

        Parameters
        ----------
        slip, traction : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces, and the tractions it goes with.
        pressure : float
            Factor of the slip by pressure: 1, or 0 of a change under a fixed pressure.
        """
        if not self._gap.size:
            return slip
        if pressure and self._slip_by_pressure is not None:
            slip = slip + backend_of(slip).xp.asarray(self._slip_by_pressure, dtype=slip.dtype)
        return backend_of(slip).add_leading_response(
            slip, traction, self._here, *self._sticking_factors
        )

    @cached_property
    def _slip_by_traction(self) -> np.ndarray:
        """Slip at the faces of leading elements per traction of the element, shape (m, 2, 2)."""
        answer = self._opening[:, :, :2] * (self._gap / self._bound)[:, None, None]
        if self._layer is not None:
            answer += self._entry[:, None, None] * self._layer
        return answer

    @cached_property
    def _slip_by_pressure(self) -> np.ndarray | None:
        """Slip at the faces of leading elements without traction, as a field, or None if zero."""
        if self._opening.shape[2] == 2:
            return None
        field = np.zeros((2, *self.bound.shape))
        field[:, *self._here] = self._opening[:, :, 2].T * self._gap
        return field

    @cached_property
    def _sticking_factors(self) -> tuple[np.ndarray, np.ndarray]:
        """Return (1/(1 + k), slip by traction/(1 + k)), k = `_stiffness`: factors in `sticking`."""
        factor = 1.0 / (1.0 + self._stiffness)
        return factor, factor[:, None, None] * self._slip_by_traction

    def _relative_traction(self, traction: np.ndarray, pressure: float = 1.0) -> np.ndarray:
        """Return the traction of the leading elements over their bound, (2, m), or (3, m).

        The third row, of `pressure`, is that of an opening with three columns.
        """
        share: np.ndarray = traction[:, *self._here] / self._bound
        if self._opening.shape[2] == 2:
            return share
        return np.concatenate((share, np.full((1, share.shape[1]), pressure)))

    def sticking_change(
        self,
        slip: np.ndarray,
        traction: np.ndarray,
        change: np.ndarray,
        gap: np.ndarray,
        at: np.ndarray,
    ) -> np.ndarray:
        """Return the derivative of `sticking` along a change of pressure, tractions, gap and slip.

        The set of leading elements is assumed not to change.

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
        at : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces at which the change is taken.
        """
        if not self._gap.size:
            return slip
        share, shifted = self._relative_traction(traction), self._relative_traction(change[1:], 0.0)
        pressed = change[0][self._here] / self._bound
        widened = gap[self._ahead] if self._gap_changes else np.zeros_like(pressed)
        shifted[:2] -= share[:2] * pressed
        sheared = change[1:][:, *self._here]
        changed = self._leading(slip, self._gap * shifted + share * widened, sheared)
        # The edge turns with the pressure around it, and with it the opening. The divisor changes,
        # too, which matters if a leading element slips.
        i, j = self._here
        angle = edge_turning(self.bound, change[0], i, j, self._aspect)
        turned = self._opening_by_angle * angle[:, None, None]
        more = np.einsum("mab,bm->am", turned, self._gap * share)
        stiffer = np.trace(turned, axis1=1, axis2=2) * self._gap
        stiffer += np.trace(self._opening, axis1=1, axis2=2) * widened
        stiffer = stiffer / self._bound - self._opened * pressed
        if self._layer is not None:
            nearer = entry_change(self.bound, change[0], i, j)
            more += nearer * (self._layer @ (self._bound * share[:2]))
            stiffer += nearer * np.trace(self._layer)
        more -= stiffer * self._leading(at, self._gap * share, self._bound * share)
        slip = slip.copy()
        slip[:, *self._here] = changed + more / (1.0 + self._stiffness)
        return slip

    def stretched(
        self, slip: np.ndarray, traction: np.ndarray, by: np.ndarray, unit: float
    ) -> np.ndarray:
        """Return the change of `sticking` for relative changes `by` of the axes and `unit` of slip.

        Parameters
        ----------
        slip, traction : ndarray
            As for `sticking`.
        by : ndarray, shape (2,)
            Relative change of both axes.
        unit : float
            Relative change of the unit of slip.
        """
        change = by[:, None, None] * self.sticking(slip, traction)
        if self._gap.size:
            stiffer = np.einsum("mkk,k->m", self._slip_by_traction, 2.0 * by - unit) / (
                1.0 + self._stiffness
            )
            share = self._relative_traction(traction)
            change[:, *self._here] -= stiffer * self._leading(
                slip, self._gap * share, self._bound * share
            )
        return change

    def _leading(self, slip: np.ndarray, times_gap: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """Return the corrected slip `sticking` at the leading elements, shape (2, m)."""
        opening = np.einsum("mab,bm->am", self._opening, times_gap)
        if self._layer is not None:
            opening += self._entry * (self._layer @ traction[:2])
        return (slip[:, *self._here] + opening) / (1.0 + self._stiffness)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """Bound on d(corrected slip)/d(own traction), (n_x, n_y); 0 except in leading elements.

        Before the division; shape (n_x, n_y), zero but in leading elements.
        """
        field = np.zeros(self.bound.shape)
        field[self._here] = self._stiffness
        return field


UPWIND = Stencil(staggered=False)
"""The paper's, eq. (28), of first order."""

STAGGERED = Stencil(staggered=True)
"""The default, of second order."""
