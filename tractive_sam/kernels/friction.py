"""Element by element: Coulomb's disc, its linearisation, and approximate inverses of it.

All functions work in the scaled tribological frame: friction is isotropic there, with the
coefficient one, and the scaled traction lies in a disc. The radius of the disc is the pressure or
the traction bound of another law (`mechanics.friction`). Fields are arrays of shape (2, n_x, n_y).

Rows of elements that do not depend on each other are computed together and without branches, so
that the compiler can use vector instructions.

Fields and names are defined in `kernels.friction`.
"""

from math import sqrt

import numpy as np

from tractive_sam.kernels.compiled import compiled

OPEN, STICK, SLIP = 0, 1, 2


@compiled(inner=True)
def _onto_disc(a, b, g, w0, w1):
    """Return (z0, z1, l): z, the point of a disc of radius g nearest to (a, b) = (1 + l w) z.

    Squares of distances are weighted by 1/w. If w are the squares of the scale factors, z is the
    nearest point of the ellipse that the disc is in unscaled tractions (`Frame`). The root l of |z|
    = g is found by Newton's method on 1/|z|, which is almost linear in l (Reinsch 1971), from
    below.
    """
    size = sqrt(a * a + b * b)
    if size <= g:
        return a, b, 0.0
    root = (size / g - 1.0) / max(w0, w1)
    if w0 == w1:
        return g * a / size, g * b / size, root
    for _ in range(50):
        u, v = 1.0 + root * w0, 1.0 + root * w1
        z0, z1 = a / u, b / v
        size = sqrt(z0 * z0 + z1 * z1)
        slope = z0 * z0 * w0 / u + z1 * z1 * w1 / v
        step = (size / g - 1.0) * size * size / slope
        root += step
        if step <= 1e-8 * root:  # the next one would be its square
            break
    z0, z1 = a / (1.0 + root * w0), b / (1.0 + root * w1)
    factor = g / sqrt(z0 * z0 + z1 * z1)
    return factor * z0, factor * z1, root


@compiled
def project(traction, bound, out, w0=1.0, w1=1.0):
    """Set `out` to tractions projected onto discs of radius `bound`; zero where bound <= 0.

    Squares of distances along the axes count by 1/w0 and 1/w1 (`_onto_disc`).
    """
    _, nx, ny = traction.shape
    for i in range(nx):
        for j in range(ny):
            a, b, g = traction[0, i, j], traction[1, i, j], bound[i, j]
            square = a * a + b * b
            outside = square > g * g or g <= 0.0
            size = sqrt(square) if square > 0.0 else 1.0
            factor = max(g, 0.0) / size if outside else 1.0
            out[0, i, j], out[1, i, j] = factor * a + 0.0, factor * b + 0.0  # no -0
        if w0 != w1:
            for j in range(ny):
                a, b, g = traction[0, i, j], traction[1, i, j], bound[i, j]
                if g > 0.0:
                    out[0, i, j], out[1, i, j], _ = _onto_disc(a, b, g, w0, w1)


@compiled(inner=True)
def _centre_slip(slip, contact, i, ahead, m0, m1):
    """Set (m0, m1) to the slip at the element centres of row i, from the slip of leading faces.

    The faces lie `ahead` / 2 elements before the centres. The slip is interpolated by a parabola
    through the face ahead, the element's own and the one behind. For faces half an element before
    the centres its weights are -1/8, 3/4 and 3/8, which damp odd-even waves as the own face does.
    If the face ahead belongs to a leading element, at the edge of contact, a straight line is used.
    """
    nx, ny = contact.shape
    back = 0.5 * ahead if i else 0.0
    far = i + 2 < nx
    behind, front, beyond = max(i - 1, 0), min(i + 1, nx - 1), min(i + 2, nx - 1)
    for j in range(ny):
        parabola = far and contact[front, j] > 0.0 and contact[beyond, j] > 0.0
        x = 0.5 * back * (1.0 + back) if parabola else back
        z = -0.5 * back * (1.0 - back) if parabola else 0.0
        y = 1.0 - x - z
        m0[j] = y * slip[0, i, j] + x * slip[0, behind, j] + z * slip[0, front, j]
        m1[j] = y * slip[1, i, j] + x * slip[1, behind, j] + z * slip[1, front, j]


@compiled
def centre(slip, contact, out, ahead=1.0):
    """Set `out` to the slip at centres in contact, from leading faces; elsewhere copy `slip`.

    The faces lie `ahead` / 2 elements before the centres.
    """
    nx, ny = contact.shape
    m0, m1 = np.empty(ny), np.empty(ny)
    for i in range(nx):
        _centre_slip(slip, contact, i, ahead, m0, m1)
        for j in range(ny):
            inside = contact[i, j] > 0.0
            out[0, i, j] = m0[j] if inside else slip[0, i, j]
            out[1, i, j] = m1[j] if inside else slip[1, i, j]


@compiled
def add_leading_response(slip, traction, rows, columns, factor, answer):
    """Set the slip of leading elements to factor * slip + answer . traction, in place.

    Parameters
    ----------
    slip, traction : ndarray, shape (2, nx, ny)
        Fields; the slip is changed.
    rows, columns : ndarray of int, shape (m,)
        Indices of the leading elements.
    factor, answer : ndarray, shapes (m,) and (m, 2, 2)
        The share, and the response to the traction.
    """
    for m in range(rows.size):
        i, j = rows[m], columns[m]
        for c in range(2):
            more = answer[m, c, 0] * traction[0, i, j] + answer[m, c, 1] * traction[1, i, j]
            slip[c, i, j] = factor[m] * slip[c, i, j] + more


@compiled
def remember(target, retained, contact, ahead, out):
    """Set `out` to ratios mu/mu(0) that relax to targets as material passes the contact (memory).

    Each element keeps a part of the share of the one ahead, which enters the contact with one.
    ``ahead`` is set to the share of the element ahead.
    """
    nx, ny = contact.shape
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            ahead[i, j] = 1.0
            if i + 1 < nx and contact[i + 1, j] > 0.0:
                ahead[i, j] = out[i + 1, j]
            out[i, j] = retained[i, j] * ahead[i, j] + (1.0 - retained[i, j]) * target[i, j]


@compiled
def change_of_bound(by_share, by_slip, retained, slip, out):
    """Set `out` to the change of a friction bound due to a change of the slip, with memory along x.

    Along x, d(share) = kept d(share of the element ahead) + by_slip . d(slip). The arrays are
    described in `Slope` of the laws.
    """
    nx, ny = by_share.shape
    share = np.zeros(ny)
    for i in range(nx - 1, -1, -1):
        for j in range(ny):
            change = by_slip[0, i, j] * slip[0, i, j] + by_slip[1, i, j] * slip[1, i, j]
            share[j] = retained[i, j] * share[j] + change
            out[i, j] = by_share[i, j] * share[j]


@compiled(inner=True)
def _centre_weight(a0, a1, m0, m1):
    """Return the centre's weight 2 g - 1/2 in [0, 1], g = 2 a.m/(a² + m²), and a² + m²."""
    square = a0 * a0 + a1 * a1 + m0 * m0 + m1 * m1
    nonzero = square >= 1e-200
    square = square if nonzero else 1.0
    agreement = 2.0 * (a0 * m0 + a1 * m1) / square if nonzero else 0.0
    return min(1.0, max(0.0, 2.0 * agreement - 0.5)), agreement, square


@compiled(inner=True)
def _turn_slip(a0, a1, m0, m1):
    """Return (s0, s1, factor): the slip that traction opposes, (a0, a1) turned towards (m0, m1)."""
    share, _, _ = _centre_weight(a0, a1, m0, m1)
    d0, d1 = a0 + share * (m0 - a0), a1 + share * (m1 - a1)
    square = d0 * d0 + d1 * d1
    turns = share > 0.0 and square >= 1e-200
    ratio = sqrt((a0 * a0 + a1 * a1) / (square if turns else 1.0))
    ratio = ratio if turns else 1.0
    return (ratio * d0 if turns else a0), (ratio * d1 if turns else a1), ratio


@compiled
def turn(slip, contact, out, ahead=1.0):
    """Set `out` to slip with its size at leading faces, its direction at centres; outside a copy.

    The slip a of the leading face gives its size and decides between stick and slip; the slip m at
    the centre gives its direction. If slip just begins, or the two disagree, the direction blends
    into the direction of a, by the share 4 a.m/(a² + m²) - 1/2, limited to 0 and 1 (well within a
    slip zone it is 1). So the law is continuous, and an element sticks rather than slip in the
    wrong direction at its leading face.

    The faces lie `ahead` / 2 elements before the centres.
    """
    nx, ny = contact.shape
    m0, m1 = np.empty(ny), np.empty(ny)
    for i in range(nx):
        _centre_slip(slip, contact, i, ahead, m0, m1)
        for j in range(ny):
            a0, a1 = slip[0, i, j], slip[1, i, j]
            s0, s1, _ = _turn_slip(a0, a1, m0[j], m1[j])
            inside = contact[i, j] > 0.0
            out[0, i, j], out[1, i, j] = (s0 if inside else a0), (s1 if inside else a1)


@compiled(inner=True)
def _respond(slip, m0, m1, staggered, s0, s1, ratio, t0, t1, i, j, across):
    """Set `across` to the derivative of the opposed slip along t, by face slip and centre slip.

    s turns with the vector d that it is turned to, s/|s| = d/|d|, but keeps the size of a.
    """
    a0, a1 = slip[0, i, j], slip[1, i, j]
    share, agreement, square, grown = 0.0, 0.0, 1.0, 0.0
    if staggered:
        share, agreement, square = _centre_weight(a0, a1, m0, m1)
        size = sqrt(a0 * a0 + a1 * a1)
        if share > 0.0 and size > 1e-100:
            # d(s) = |s| d(u), u = d/|d|: only what of a change of d is across u turns s. Its part
            # along u changes |d| alone, and |s| = |a| grows with a instead.
            u0, u1 = s0 / size, s1 / size
            onto = t0 * u0 + t1 * u1
            t0, t1 = t0 - onto * u0, t1 - onto * u1
            grown = onto / (ratio * size)
    across[0, 0, i, j] = (1.0 - share) * t0 + grown * a0
    across[0, 1, i, j] = (1.0 - share) * t1 + grown * a1
    across[1, 0, i, j], across[1, 1, i, j] = share * t0, share * t1
    if 0.0 < share < 1.0:
        # The share changes as well: the derivatives of 4 a.m/(a² + m²) by a, and by m.
        x = 4.0 * (t0 * (m0 - a0) + t1 * (m1 - a1)) / square
        across[0, 0, i, j] += x * (m0 - agreement * a0)
        across[0, 1, i, j] += x * (m1 - agreement * a1)
        across[1, 0, i, j] += x * (a0 - agreement * m0)
        across[1, 1, i, j] += x * (a1 - agreement * m1)


@compiled(inner=True)
def _set_sticking(direction, kappa, across, i, j):
    """Set `kappa` to 1, and `direction` and `across` to 0, in an element that does not slip.

    `tangent_row` multiplies by all of them: numbers that happen to be in memory may be denormal,
    which takes four times as long.
    """
    kappa[i, j] = 1.0
    direction[0, i, j] = direction[1, i, j] = 0.0
    across[0, 0, i, j] = across[0, 1, i, j] = across[1, 0, i, j] = across[1, 1, i, j] = 0.0


@compiled
def linearise(
    traction, slip, bound, contact, staggered, weights, state, direction, kappa, across, defect
):
    """Set `state` to `defect` of the linearised law; return three sums of squares.

    Parameters
    ----------
    traction, slip : ndarray, shape (2, nx, ny)
        Current iterate and the slip of its leading faces.
    bound, contact : ndarray, shape (nx, ny)
        Radius of the disc, and an array that is positive in contact.
    staggered : float
        How far the slip opposed is turned back, to that at the centre (`turn`); 0: not at all.
    weights : tuple of float
        w0, w1 : of the slip along the axes, which define the norm of the projection
        (`_onto_disc`); the solution does not depend on them. Then the weight of the first column in
        the sums: 1, or 1/2 if an axis of symmetry halves it.
    state : ndarray of int8, shape (nx, ny)
        Set to OPEN, STICK or SLIP.
    direction : ndarray, shape (2, nx, ny)
        Set to the unit vector of disc(p - w s) in elements that slip.
    kappa : ndarray, shape (nx, ny)
        Set to k = 1/(1 + l) in elements that slip (`_onto_disc`), to 1 in elements that stick. With
        equal weights it is the derivative of the projection across the direction of slip, bound/|p
        - s|. If slip was turned from a vector of another size, k and the defect are scaled so that
        the row is written in that vector.
    across : ndarray, shape (2, 2, nx, ny)
        Set to the response of the opposed slip to the slip at the leading face (first index 0) and
        at the centre (1), across the direction of slip, in elements that slip, else to zero.
    defect : ndarray, shape (2, nx, ny)
        Set to disc(p - w s) - p, the part across the direction of slip scaled like its row.

    Returns
    -------
    total : float
        Sum of squares of disc(p - s) - p, with unit weights.
    merit : float
        Sum of squares of disc(p - w s) - p, in the norm of the weights.
    reached : float
        Sum of squares of p plus its `defect`.
    """
    nx, ny = bound.shape
    total = merit = reached = 0.0
    w0, w1, first = weights
    inverse0, inverse1 = 1.0 / w0, 1.0 / w1
    centre, turned, ratios = np.empty((2, ny)), np.empty((2, ny)), np.ones(ny)
    for i in range(nx):
        for j in range(ny):
            centre[0, j], centre[1, j] = slip[0, i, j], slip[1, i, j]
            turned[0, j], turned[1, j] = slip[0, i, j], slip[1, i, j]
        if staggered:
            _centre_slip(slip, contact, i, 1.0 * staggered, centre[0], centre[1])
            for j in range(ny):
                turned[0, j], turned[1, j], ratios[j] = _turn_slip(
                    slip[0, i, j], slip[1, i, j], centre[0, j], centre[1, j]
                )
        for j in range(ny):
            g, share = bound[i, j], 1.0 if j else first
            p0, p1, m0, m1 = traction[0, i, j], traction[1, i, j], centre[0, j], centre[1, j]
            s0, s1, ratio = turned[0, j], turned[1, j], ratios[j]
            _set_sticking(direction, kappa, across, i, j)
            if g <= 0.0:
                state[i, j] = OPEN
                d0, d1 = -p0, -p1
                total += share * (d0 * d0 + d1 * d1)
                merit += share * (d0 * d0 * inverse0 + d1 * d1 * inverse1)
                defect[0, i, j], defect[1, i, j] = d0, d1
                continue
            z0, z1, root = _onto_disc(p0 - s0, p1 - s1, g, 1.0, 1.0)
            total += share * ((z0 - p0) ** 2 + (z1 - p1) ** 2)
            if w0 != 1.0 or w1 != 1.0:
                z0, z1, root = _onto_disc(p0 - w0 * s0, p1 - w1 * s1, g, w0, w1)
            d0, d1 = z0 - p0, z1 - p1
            merit += share * (d0 * d0 * inverse0 + d1 * d1 * inverse1)
            if root == 0.0:
                # Here disc(p - w s) - p = -w s. The row asks it of the slip of the leading face,
                # which has the size of s but is linear in the tractions, unlike the turned one.
                state[i, j] = STICK
                d0, d1 = -slip[0, i, j], -slip[1, i, j]
            else:
                state[i, j] = SLIP
                n0, n1 = z0 / g, z1 / g
                # A hundredth of an ulp of pressure must not make 1/kappa infinite.
                k = max(1.0 / (1.0 + root), 1e-100)
                along, out = n0 * d1 - n1 * d0, n0 * d0 + n1 * d1
                if w0 != 1.0 or w1 != 1.0:
                    # From (1 + l w) z = p - w s, differentiated and multiplied by t/w.
                    scaled = (n1 * n1 * inverse0 + n0 * n0 * inverse1) * along
                    scaled += n0 * n1 * (inverse1 - inverse0) * out
                    along = k * scaled + (1.0 - k) * along
                if ratio != 1.0:
                    # In k t.s + (1 - k) t.p the response of t.s is `ratio` times `across`. Division
                    # by the sum of both shares gives a row of this form with another k.
                    scale = 1.0 / (k * ratio + 1.0 - k)
                    k = max(scale * k * ratio, 1e-100)
                    along *= scale
                d0, d1 = out * n0 - along * n1, out * n1 + along * n0
                direction[0, i, j], direction[1, i, j] = n0, n1
                kappa[i, j] = k
                _respond(slip, m0, m1, staggered, s0, s1, ratio, -n1, n0, i, j, across)
            defect[0, i, j], defect[1, i, j] = d0, d1
            reached += share * ((p0 + d0) ** 2 + (p1 + d1) ** 2)
    return total, merit, reached


@compiled
def tangent_row(state, direction, kappa, across, contact, step, slip, out, ahead=1.0):
    """Set `out` to the linearised friction law applied to a change of traction and of slip.

    An element that sticks gives s; one that slips kappa t.s + (1 - kappa) t.p along t, and n.p
    along the direction n of the traction; an open one p. ``step`` is a change p of traction,
    ``slip`` the change s of slip of the leading faces that it causes, and ``across`` defines t.s
    (`linearise`, `turn`).
    """
    nx, ny = state.shape
    m0, m1 = np.zeros(ny), np.zeros(ny)
    for i in range(nx):
        if ahead > 0.0:
            _centre_slip(slip, contact, i, ahead, m0, m1)
        for j in range(ny):
            sticks, slips = state[i, j] == STICK, state[i, j] == SLIP
            t0, t1, k = -direction[1, i, j], direction[0, i, j], kappa[i, j]
            along = across[0, 0, i, j] * slip[0, i, j] + across[0, 1, i, j] * slip[1, i, j]
            along += across[1, 0, i, j] * m0[j] + across[1, 1, i, j] * m1[j]
            p0, p1 = step[0, i, j], step[1, i, j]
            value, out_of = k * along + (1.0 - k) * (t0 * p0 + t1 * p1), t1 * p0 - t0 * p1
            slid0, slid1 = value * t0 + out_of * t1, value * t1 - out_of * t0
            out[0, i, j] = slid0 if slips else (slip[0, i, j] if sticks else p0)
            out[1, i, j] = slid1 if slips else (slip[1, i, j] if sticks else p1)


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
