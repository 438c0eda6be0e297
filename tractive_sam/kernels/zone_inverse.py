"""Approximate inverse of the friction conditions in steady rolling, with weights at zone borders.

Fields and names are defined in `kernels.friction`, the method in `operators.zone_inverse`.
"""

from math import log, sqrt

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.friction import OPEN, SLIP, STICK


@compiled
def prepare_zones(
    state, direction, kappa, stiffness, trace, edge, tuning, nodes, table, weights, places, border
):
    """Set the weights of elements and of the borders of stick zones; return the number of these.

    Parameters
    ----------
    state, direction, kappa, stiffness : ndarray
        The linearised law, and `operators.stencil.FrictionSlip.stiffness`.
    trace : float
        Trace of the slip of an element due to its own traction.
    edge : ndarray, shape (3,)
        Entries (11, 12, 22) of the inverse of the response to waves along x.
    tuning : tuple of float
        Length of a border, elements, its exponent, the weight of the leading edge, and the length
        there, elements.
    nodes, table : ndarray, shapes (m,) and (2, m)
        Equidistant logarithms of the local term gamma, and the weights of the damped inverse and
        of the row for them.
    weights : ndarray, shape (7, nx, ny)
        Set to the tangent t of slip (2), factors of the row where elements stick and along t, the
        weight of the sum from the leading edge, and both weights of a slipping element; each is
        zero elsewhere.
    places : ndarray of int, shape (2, m)
        Set to the indices of the elements at borders.
    border : ndarray, shape (5, m)
        Set to the direction n of slip behind the border, the direction of its response, and the
        weight.
    """
    nx, ny = state.shape
    length, exponent, leading, reach = tuning
    count, last, step = 0, nodes.size - 1, nodes[1] - nodes[0]
    behind, n0, n1, ahead = np.zeros(ny), np.ones(ny), np.zeros(ny), np.zeros(ny)
    for i in range(nx):
        for j in range(ny):
            w = stiffness[i, j]
            for c in range(7):
                weights[c, i, j] = 0.0
            if state[i, j] == STICK:
                behind[j] += 1.0
                weights[2, i, j] = trace * (1.0 + w) / (trace + 0.5 * w)
                distance = (behind[j] - 0.5) / length
                if distance < 1.0:
                    e0, e1 = edge[0] * n0[j] + edge[1] * n1[j], edge[1] * n0[j] + edge[2] * n1[j]
                    size = e0 * n0[j] + e1 * n1[j]
                    places[0, count], places[1, count] = i, j
                    border[0, count], border[1, count] = n0[j], n1[j]
                    border[2, count], border[3, count] = e0 / size, e1 / size
                    border[4, count] = distance**-exponent
                    count += 1
                continue
            behind[j] = 0.0
            n0[j], n1[j] = 1.0, 0.0
            if state[i, j] == SLIP:
                n0[j], n1[j], k = direction[0, i, j], direction[1, i, j], kappa[i, j]
                factor = (1.0 + w) / k
                gamma = 0.5 * w + factor * (1.0 - k)
                # Beyond the last node both weights are proportional to 1/gamma.
                place = (log(max(gamma, 1e-100)) - nodes[0]) / step
                scale = min(1.0, np.exp(nodes[last]) / max(gamma, 1e-100))
                place = min(max(place, 0.0), last - 1e-9)
                q = int(place)
                part = place - q
                weights[0, i, j], weights[1, i, j], weights[3, i, j] = -n1[j], n0[j], factor
                weights[5, i, j] = scale * ((1.0 - part) * table[0, q] + part * table[0, q + 1])
                local = scale * ((1.0 - part) * table[1, q] + part * table[1, q + 1])
                weights[6, i, j] = local * factor
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            ahead[j] = 0.0 if state[i, j] == OPEN else ahead[j] + 1.0
            if state[i, j] == STICK:
                near = max(0.0, 1.0 / sqrt(ahead[j] - 0.5) - 1.0 / sqrt(reach))
                weights[4, i, j] = 1.0 + leading * near
    return count


@compiled
def weight_rows(weights, places, border, count, row, out):
    """Set `out` to the rows that both inverses take: weighted at borders, in slip along t only."""
    _, nx, ny = row.shape
    for i in range(nx):
        for j in range(ny):
            t0, t1, r0, r1 = weights[0, i, j], weights[1, i, j], row[0, i, j], row[1, i, j]
            along = weights[3, i, j] * (t0 * r0 + t1 * r1)
            out[0, i, j] = weights[2, i, j] * r0 + t0 * along
            out[1, i, j] = weights[2, i, j] * r1 + t1 * along
    one = weights.dtype.type(1)
    for b in range(count):
        i, j = places[0, b], places[1, b]
        more = border[2, b] * out[0, i, j] + border[3, b] * out[1, i, j]
        more *= one / border[4, b] - one
        out[0, i, j] += border[0, b] * more
        out[1, i, j] += border[1, b] * more


@compiled
def combine_zones(weights, places, border, count, row, smooth, damped, out):
    """Set `out` to tractions: sums of `smooth` from the leading edge, `damped` in slip.

    The part of a slipping element along its direction, and all of an open one, is the row.
    """
    _, nx, ny = row.shape
    one, zero = weights.dtype.type(1), weights.dtype.type(0)
    sum0, sum1 = np.zeros(ny, out.dtype), np.zeros(ny, out.dtype)
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            t0, t1, r0, r1 = weights[0, i, j], weights[1, i, j], row[0, i, j], row[1, i, j]
            leading, along = weights[4, i, j], t0 * r0 + t1 * r1
            tau = weights[5, i, j] * (t0 * damped[0, i, j] + t1 * damped[1, i, j])
            tau += weights[6, i, j] * along
            sticks = one if leading > zero else zero
            sum0[j] = sticks * sum0[j] + leading * smooth[0, i, j] + tau * t0
            sum1[j] = sticks * sum1[j] + leading * smooth[1, i, j] + tau * t1
            out[0, i, j] = sum0[j] + (one - sticks) * (r0 - along * t0)
            out[1, i, j] = sum1[j] + (one - sticks) * (r1 - along * t1)
    for b in range(count):
        i, j = places[0, b], places[1, b]
        more = border[0, b] * out[0, i, j] + border[1, b] * out[1, i, j]
        more *= border[4, b] - one
        out[0, i, j] += border[2, b] * more
        out[1, i, j] += border[3, b] * more
