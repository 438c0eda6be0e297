"""Element by element: Coulomb's disc, its linearisation, and the upwind sweep.

All in the scaled tribological frame, where friction is isotropic with unit coefficient: the scaled
traction lies in a disc whose radius is the pressure. Fields are arrays of shape (2, n_x, n_y).
"""

from math import sqrt

import numpy as np
from numba import njit

OPEN, STICK, SLIP = 0, 1, 2


@njit(cache=True)
def project(traction, bound, out):
    """Nearest point of the disc of radius ``bound``, element by element; zero where bound <= 0."""
    _, nx, ny = traction.shape
    for i in range(nx):
        for j in range(ny):
            a, b, g = traction[0, i, j], traction[1, i, j], bound[i, j]
            size = sqrt(a * a + b * b)
            if g <= 0.0:
                factor = 0.0
            elif size > g:
                factor = g / size
            else:
                factor = 1.0
            out[0, i, j] = factor * a
            out[1, i, j] = factor * b


@njit(cache=True)
def linearise(traction, slip, bound, state, direction, kappa, defect):
    """State of every element and the defect of the friction law, disc(p - s) - p.

    Parameters
    ----------
    traction, slip : ndarray, shape (2, nx, ny)
        Current iterate and its slip.
    bound : ndarray, shape (nx, ny)
        Radius of the disc.
    state : ndarray of int8, shape (nx, ny)
        Set to OPEN, STICK or SLIP.
    direction : ndarray, shape (2, nx, ny)
        Set to the unit vector of p - s where the element slips.
    kappa : ndarray, shape (nx, ny)
        Set to the derivative of the projection across the direction of slip: bound/|p - s| where
        it slips, 1 where it sticks.
    defect : ndarray, shape (2, nx, ny)
        Set to disc(p - s) - p.

    Returns
    -------
    float
        Sum of squares of the defect.
    """
    nx, ny = bound.shape
    total = 0.0
    for i in range(nx):
        for j in range(ny):
            g = bound[i, j]
            p0, p1 = traction[0, i, j], traction[1, i, j]
            q0, q1 = p0 - slip[0, i, j], p1 - slip[1, i, j]
            direction[0, i, j] = direction[1, i, j] = 0.0
            kappa[i, j] = 1.0
            if g <= 0.0:
                state[i, j] = OPEN
                q0 = q1 = 0.0
            else:
                size = sqrt(q0 * q0 + q1 * q1)
                if size <= g:
                    state[i, j] = STICK
                else:
                    state[i, j] = SLIP
                    direction[0, i, j], direction[1, i, j] = q0 / size, q1 / size
                    # A hundredth of an ulp of pressure must not make 1/kappa infinite.
                    kappa[i, j] = max(g / size, 1e-100)
                    q0, q1 = g * direction[0, i, j], g * direction[1, i, j]
            defect[0, i, j], defect[1, i, j] = q0 - p0, q1 - p1
            total += defect[0, i, j] ** 2 + defect[1, i, j] ** 2
    return total


@njit(cache=True)
def tangent_row(state, direction, kappa, step, slip, out):
    """Rows of the linearised friction law: s where it sticks, kappa t.s + (1 - kappa) t.p along t.

    ``step`` and ``slip`` are a change of traction and the change of slip it causes; ``t`` is
    perpendicular to the direction of slip. Components that are no unknowns are set to zero.
    """
    nx, ny = state.shape
    for i in range(nx):
        for j in range(ny):
            if state[i, j] == STICK:
                out[0, i, j], out[1, i, j] = slip[0, i, j], slip[1, i, j]
            elif state[i, j] == SLIP:
                t0, t1, k = -direction[1, i, j], direction[0, i, j], kappa[i, j]
                value = k * (t0 * slip[0, i, j] + t1 * slip[1, i, j]) + (1.0 - k) * (
                    t0 * step[0, i, j] + t1 * step[1, i, j]
                )
                out[0, i, j], out[1, i, j] = value * t0, value * t1
            else:
                out[0, i, j] = out[1, i, j] = 0.0


@njit(cache=True)
def split(state, direction, kappa, own, row, smooth, rough):
    """Divide a residual between the two halves of the upwind-sweep preconditioner.

    Where elements stick the circulant inverse takes all of it (``smooth``). Where they slip, the
    local term gamma = 1/kappa - 1 competes with the elastic one, of the size of the element's slip
    of itself, d = t.D t; the circulant inverse takes the share 2 d/(2 d + gamma), the rest
    (``rough``, a scalar along t) is left to the sweep.
    """
    nx, ny = state.shape
    for i in range(nx):
        for j in range(ny):
            smooth[0, i, j] = smooth[1, i, j] = rough[i, j] = 0.0
            if state[i, j] == STICK:
                smooth[0, i, j], smooth[1, i, j] = row[0, i, j], row[1, i, j]
            elif state[i, j] == SLIP:
                t0, t1, k = -direction[1, i, j], direction[0, i, j], kappa[i, j]
                d = own[0] * t0 * t0 + 2.0 * own[1] * t0 * t1 + own[2] * t1 * t1
                value = (t0 * row[0, i, j] + t1 * row[1, i, j]) / k
                share = 2.0 * d / (2.0 * d + 1.0 / k - 1.0)
                rough[i, j] = (1.0 - share) * value
                smooth[0, i, j], smooth[1, i, j] = share * value * t0, share * value * t1


@njit(cache=True)
def sweep(state, direction, kappa, own, smooth, rough, out):
    """Integrate from the leading edge of every row, where the traction is zero.

    ``smooth`` is what the circulant inverse made of its share: the increment of traction from one
    element to the next. An element that slips keeps only the part along t, and its local term
    gamma holds it back: 2 d (tau - tau_ahead) + gamma tau = rough.
    """
    nx, ny = state.shape
    ahead = np.zeros((2, ny))
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            if state[i, j] == OPEN:
                ahead[0, j] = ahead[1, j] = 0.0
                out[0, i, j] = out[1, i, j] = 0.0
                continue
            a = ahead[0, j] + smooth[0, i, j]
            b = ahead[1, j] + smooth[1, i, j]
            if state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                d = 2.0 * (own[0] * t0 * t0 + 2.0 * own[1] * t0 * t1 + own[2] * t1 * t1)
                tau = (d * (a * t0 + b * t1) + rough[i, j]) / (d + 1.0 / kappa[i, j] - 1.0)
                a, b = tau * t0, tau * t1
            ahead[0, j], ahead[1, j] = a, b
            out[0, i, j], out[1, i, j] = a, b
