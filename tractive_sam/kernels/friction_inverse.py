"""Approximate inverses of the linearised friction law: by an upwind sweep, and in a step.

Fields and names are defined in `kernels.friction`.
"""

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.friction import OPEN, SLIP, STICK


@compiled
def prepare_sweep(state, direction, kappa, stiffness, D, share, elastic, local):
    """Set `share`, `elastic` and `local`, the row factors of the upwind-sweep preconditioner.

    A local term gamma competes with the elastic one, of the size of the element's slip of itself,
    d = t.D t: of leading elements half the bound w (``stiffness``) on their response to the opening
    ahead, and of those that slip 1/kappa - 1, which counts 1 + w times since a row is divided by
    that (`operators.stencil.FrictionSlip`). The circulant inverse takes the share 2 d/(2 d + gamma)
    of a row; of an element that slips, the rest is left to the sweep.

    Parameters
    ----------
    share, elastic, local : ndarray, shape (n_x, n_y)
        Set to the factors of a row in the part of the circulant inverse, of the elastic sum in the
        traction along t of an element that slips, and of its row in that traction.
    """
    nx, ny = state.shape
    trace = D[0] + D[2]
    for i in range(nx):
        for j in range(ny):
            w, k = stiffness[i, j], kappa[i, j]
            share[i, j] = elastic[i, j] = local[i, j] = 0.0
            if state[i, j] == STICK:
                share[i, j] = trace * (1.0 + w) / (trace + 0.5 * w)
            elif state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                d = D[0] * t0 * t0 + 2.0 * D[1] * t0 * t1 + D[2] * t1 * t1
                # Times kappa, by which the row is divided.
                gamma = 0.5 * w * k + (1.0 + w) * (1.0 - k)
                total = 2.0 * k * d + gamma
                share[i, j] = 2.0 * (1.0 + w) / total
                elastic[i, j] = 2.0 * k / total
                local[i, j] = gamma * (1.0 + w) / (total * total)


@compiled
def divide_rows(state, direction, share, D, row, smooth):
    """Set `smooth` to share times row; for slip elements to D t times the part along t.

    The row of an element that slips is one number, D one of 2 x 2: as a vector the row goes along
    D t, what a traction along t makes of slip. Along t itself its part in the weaker direction of
    slip would be taken for traction there, too large by mu1²/mu2² (`sweep_upwind`).
    """
    nx, ny = state.shape
    for i in range(nx):
        for j in range(ny):
            r0, r1 = share[i, j] * row[0, i, j], share[i, j] * row[1, i, j]
            if state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                value = t0 * r0 + t1 * r1
                r0, r1 = value * (D[0] * t0 + D[1] * t1), value * (D[1] * t0 + D[2] * t1)
            smooth[0, i, j], smooth[1, i, j] = r0, r1


@compiled
def sweep_upwind(state, direction, elastic, local, D, row, smooth, out):
    """Set `out` to the traction of the preconditioner: smooth parts summed from the leading edge.

    The traction is zero at the leading edge. ``row`` is the residual of the linearised problem,
    which `divide_rows` divides.

    ``smooth`` is what the circulant inverse made of its share: the increment of traction from one
    element to the next. In an element that slips only the part tau along t is integrated, with t.D
    (t tau) = t.D (ahead + smooth). A local term gamma restrains it, implicitly:
    2 t.D (t tau - ahead - smooth) + gamma tau = the rest of the row (`prepare_sweep`). The part
    along the direction of slip, and both parts in an open element, are taken from ``row``.
    """
    nx, ny = state.shape
    ahead = np.zeros((2, ny))
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            r0, r1 = row[0, i, j], row[1, i, j]
            if state[i, j] == OPEN:
                ahead[0, j] = ahead[1, j] = 0.0
                out[0, i, j], out[1, i, j] = r0, r1
                continue
            a = ahead[0, j] + smooth[0, i, j]
            b = ahead[1, j] + smooth[1, i, j]
            if state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                sheared = (D[0] * t0 + D[1] * t1) * a + (D[1] * t0 + D[2] * t1) * b
                tau = elastic[i, j] * sheared + local[i, j] * (t0 * r0 + t1 * r1)
                # The known part of the traction along its direction is left out of the sum: it
                # saves no iterations, and misleads if the coefficients differ much.
                a, b = tau * t0, tau * t1
                out_of = t1 * r0 - t0 * r1
                out[0, i, j], out[1, i, j] = a + out_of * t1, b - out_of * t0
            else:
                out[0, i, j], out[1, i, j] = a, b
            ahead[0, j], ahead[1, j] = a, b


@compiled
def prepare_step(
    state, direction, kappa, across, contact, stiffness, D, ahead, rough, share, behind, front, up
):
    """Set `rough`, `share`, `behind`, `front` and `up`, factors of the inverse for a time step.

    As in `prepare_sweep`, for rows in the displacement itself. A local term gamma competes with d,
    the displacement of an element under its own traction. An approximate inverse of A + gamma is

        q C q + gamma/(d + gamma)²,    q = d/(d + gamma),

    with the circulant inverse C of A. It is exact for any gamma if A is d, and never far off, for
    uniform and for varying gamma.

    The slip opposed is a mean of faces (`turn`): a tridiagonal matrix along x takes the rows of
    slipping elements back to the slip of the leading faces. The slip of elements that stick is
    known.

    Parameters
    ----------
    rough, share : ndarray, shape (n_x, n_y)
        Set to the factor of a row in its local part, and to q.
    behind, front : ndarray, shape (n_x, n_y)
        Set to the coefficients of the neighbours in the tridiagonal matrix.
    up : ndarray, shape (2, n_x, n_y)
        Set to the inverse pivot, and to the coefficient that elimination leaves in front.
    """
    nx, ny = state.shape
    back = 0.5 * ahead
    for i in range(nx):
        b = back if i else 0.0
        for j in range(ny):
            rough[i, j] = share[i, j] = behind[i, j] = front[i, j] = 0.0
            up[0, i, j], up[1, i, j] = 1.0, 0.0
            if state[i, j] == OPEN:
                continue
            w, k, d = stiffness[i, j], kappa[i, j], 0.5 * (D[0] + D[2])
            t0, t1 = -direction[1, i, j], direction[0, i, j]
            if state[i, j] == SLIP:
                d = D[0] * t0 * t0 + 2.0 * D[1] * t0 * t1 + D[2] * t1 * t1
            # A leading element answers with about half the trace that its stiffness is. Times
            # kappa, by which the row is divided.
            gamma = 0.5 * w * k + (1.0 + w) * (1.0 - k)
            total = k * d + gamma
            share[i, j] = k * d / total
            rough[i, j] = (1.0 + w) * gamma / (total * total)
            if state[i, j] != SLIP or ahead <= 0.0:
                continue
            turned = across[1, 0, i, j] * t0 + across[1, 1, i, j] * t1
            here, before = 1.0 - b, 0.0
            if i + 2 < nx and contact[i + 1, j] > 0.0 and contact[i + 2, j] > 0.0:
                before = -0.5 * b * here
                b, here = 0.5 * b * (1.0 + b), 1.0 - b * b
            diagonal = across[0, 0, i, j] * t0 + across[0, 1, i, j] * t1 + turned * here
            if i and state[i - 1, j] != OPEN:
                behind[i, j] = turned * b
            else:
                diagonal += turned * b
            if before != 0.0 and state[i + 1, j] != OPEN:
                front[i, j] = turned * before
            if behind[i, j] != 0.0 and state[i - 1, j] == SLIP:
                diagonal -= behind[i, j] * up[1, i - 1, j]
            up[0, i, j] = 1.0 / diagonal
            if front[i, j] != 0.0 and state[i + 1, j] == SLIP:
                up[1, i, j] = front[i, j] / diagonal
            b = back if i else 0.0


@compiled
def share_out(state, direction, kappa, stiffness, share, behind, front, up, row, along, smooth):
    """Set `smooth`, which the circulant inverse takes of a residual, and `along`, rows of slip.

    ``smooth`` is set to the part of the circulant inverse, and ``along`` to the rows over kappa,
    of elements that slip along t and as slip of the leading faces (`prepare_step`).
    """
    nx, ny = state.shape
    for i in range(nx):
        for j in range(ny):
            smooth[0, i, j] = smooth[1, i, j] = 0.0
            if state[i, j] == STICK:
                q = share[i, j] * (1.0 + stiffness[i, j])
                smooth[0, i, j], smooth[1, i, j] = q * row[0, i, j], q * row[1, i, j]
            elif state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                scale = (1.0 + stiffness[i, j]) / kappa[i, j]
                value = scale * (t0 * row[0, i, j] + t1 * row[1, i, j])
                if behind[i, j] != 0.0:
                    if state[i - 1, j] == SLIP:
                        value -= behind[i, j] * along[i - 1, j]
                    else:
                        scale = behind[i, j] * (1.0 + stiffness[i - 1, j])
                        value -= scale * (t0 * row[0, i - 1, j] + t1 * row[1, i - 1, j])
                if front[i, j] != 0.0 and state[i + 1, j] == STICK:
                    scale = front[i, j] * (1.0 + stiffness[i + 1, j])
                    value -= scale * (t0 * row[0, i + 1, j] + t1 * row[1, i + 1, j])
                along[i, j] = value * up[0, i, j]
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            if state[i, j] == SLIP:
                if up[1, i, j] != 0.0:
                    along[i, j] -= up[1, i, j] * along[i + 1, j]
                value = share[i, j] * along[i, j]
                smooth[0, i, j] = -direction[1, i, j] * value
                smooth[1, i, j] = direction[0, i, j] * value


@compiled
def gather(state, direction, share, rough, row, smooth, out):
    """Set `out` to share*smooth + rough*row if stuck, and along t in slip; otherwise to `row`.

    The part along its direction, and all of an open one, is what ``row`` says.
    """
    nx, ny = state.shape
    for i in range(nx):
        for j in range(ny):
            q, r0, r1 = share[i, j], row[0, i, j], row[1, i, j]
            if state[i, j] == STICK:
                r0 = q * smooth[0, i, j] + rough[i, j] * r0
                r1 = q * smooth[1, i, j] + rough[i, j] * r1
            elif state[i, j] == SLIP:
                t0, t1 = -direction[1, i, j], direction[0, i, j]
                tau = q * (t0 * smooth[0, i, j] + t1 * smooth[1, i, j])
                tau += rough[i, j] * (t0 * r0 + t1 * r1)
                out_of = t1 * r0 - t0 * r1
                r0, r1 = tau * t0 + out_of * t1, tau * t1 - out_of * t0
            out[0, i, j], out[1, i, j] = r0, r1
