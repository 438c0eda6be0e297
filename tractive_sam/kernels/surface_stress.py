"""Stress at a surface from the displacements that tractions on it cause: transforms and Hooke."""

from tractive_sam.kernels.compiled import compiled


@compiled
def displacement_product(out, spectra, even, odd):
    """Set `out` to spectra of surface displacements (u, v) from spectra of the tractions.

    Parameters
    ----------
    out : ndarray of complex, shape (4, p_x, m)
        Set to the spectra of (u_x, u_y) by p_x and p_y, and of (u_x, u_y) by p_n.
    spectra : ndarray of complex, shape (3, p_x, m)
        Spectra of (p_x, p_y, p_n).
    even : ndarray, shape (3, p_x, m)
        Spectra of the coefficients xx, xy and yy, which are real.
    odd : ndarray, shape (2, p_x, m)
        Spectra of xz and yz, imaginary ones: their imaginary parts.
    """
    _, px, half = spectra.shape
    for i in range(px):
        for j in range(half):
            x, y, n = spectra[0, i, j], spectra[1, i, j], spectra[2, i, j]
            i_n = complex(-n.imag, n.real)
            xy = even[1, i, j]
            out[0, i, j] = even[0, i, j] * x + xy * y
            out[1, i, j] = xy * x + even[2, i, j] * y
            out[2, i, j] = odd[0, i, j] * i_n
            out[3, i, j] = odd[1, i, j] * i_n


@compiled
def at_corners(out, displacement, tractions, signs, dx, dy, nu):
    """Set `out` to the surface stresses of each body at element corners, by strain and Hooke's law.

    Parameters
    ----------
    out : ndarray, shape (bodies, 6, n_x - 1, n_y - 1), for strips (bodies, 6, n_x - 1, 1)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    displacement : ndarray, shape (4, n_x, n_y)
        (u_x, u_y) at the centres by p_x and p_y, and by p_n, for a shear modulus of one unit of the
        tractions.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on the elements, as in `kernels.stress`.
    signs : sequence of float
        Factors of p_x and p_y, for each body.
    dx, dy : float
        Sides of the elements.
    nu : float
        Poisson's ratio.
    """
    plane, by_pressure = 2.0 / (1.0 - nu), nu / (1.0 - nu)
    _, _, nx, ny = out.shape
    last = tractions.shape[2] - 1
    p_x, p_y, p_n = tractions
    for i in range(nx):
        for j in range(ny):
            k = min(j + 1, last)  # strips do not change in y
            x, y, n = _mean(p_x, i, j, k), _mean(p_y, i, j, k), _mean(p_n, i, j, k)
            xx, yy, xy = _strain(displacement[0], displacement[1], i, j, k, dx, dy)
            n_xx, n_yy, n_xy = _strain(displacement[2], displacement[3], i, j, k, dx, dy)
            for b, s in enumerate(signs):
                e, f = n_xx + s * xx, n_yy + s * yy
                out[b, 0, i, j] = plane * (e + nu * f) - by_pressure * n
                out[b, 1, i, j] = plane * (f + nu * e) - by_pressure * n
                out[b, 2, i, j] = -n
                out[b, 3, i, j] = n_xy + s * xy
                out[b, 4, i, j] = -s * x
                out[b, 5, i, j] = -s * y


@compiled(inner=True)
def _strain(u, v, i, j, k, dx, dy):
    """Return strain xx, yy and twice xy at a corner, from displacements u, v around it."""
    xx = 0.5 / dx * (u[i + 1, j] + u[i + 1, k] - u[i, j] - u[i, k])
    yx = 0.5 / dx * (v[i + 1, j] + v[i + 1, k] - v[i, j] - v[i, k])
    xy = 0.5 / dy * (u[i, k] + u[i + 1, k] - u[i, j] - u[i + 1, j])
    yy = 0.5 / dy * (v[i, k] + v[i + 1, k] - v[i, j] - v[i + 1, j])
    return xx, yy, xy + yx


@compiled(inner=True)
def _mean(field, i, j, k):
    """Return the mean of a field over the elements around a corner."""
    return 0.25 * (field[i, j] + field[i + 1, j] + field[i, k] + field[i + 1, k])
