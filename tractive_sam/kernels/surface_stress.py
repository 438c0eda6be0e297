"""Stress at a surface from the displacements that tractions on it cause: transforms and Hooke."""

from tractive_sam.kernels.compiled import compiled


@compiled
def displacement_product(spectra, even, odd):
    """Spectra of tractions into those of displacements in the plane, in place.

    Parameters
    ----------
    spectra : ndarray of complex, shape (bodies, 3, p_x, m)
        Those of (p_x, p_y, p_n); then those of (u_x, u_y, p_n).
    even : ndarray, shape (3, p_x, m)
        Spectra of the coefficients xx, xy and yy, which are real.
    odd : ndarray, shape (2, p_x, m)
        Spectra of xz and yz, imaginary ones: their imaginary parts.
    """
    bodies, _, px, half = spectra.shape
    for b in range(bodies):
        for i in range(px):
            for j in range(half):
                x, y, n = spectra[b, 0, i, j], spectra[b, 1, i, j], spectra[b, 2, i, j]
                i_n = complex(-n.imag, n.real)
                xy = even[1, i, j]
                spectra[b, 0, i, j] = even[0, i, j] * x + xy * y + odd[0, i, j] * i_n
                spectra[b, 1, i, j] = xy * x + even[2, i, j] * y + odd[1, i, j] * i_n


@compiled
def at_corners(out, displacement, tractions, dx, dy, nu):
    """Set the stresses at corners of elements: strain by differences, stress by Hooke's law.

    Parameters
    ----------
    out : ndarray, shape (bodies, 6, n_x - 1, n_y - 1), of strips (bodies, 6, n_x - 1, 1)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    displacement : ndarray, shape (bodies, 2, n_x, n_y)
        (u_x, u_y) at the centres for a shear modulus of one unit of the tractions.
    tractions : ndarray, shape (bodies, 3, n_x, n_y)
        (p_x, p_y, p_n) on the elements, as in `kernels.stress`.
    dx, dy : float
        Sides of the elements.
    nu : float
        Poisson's ratio.
    """
    plane, by_pressure = 2.0 / (1.0 - nu), nu / (1.0 - nu)
    bodies, _, nx, ny = out.shape
    last = tractions.shape[3] - 1
    for b in range(bodies):
        u, v, p = displacement[b, 0], displacement[b, 1], tractions[b]
        for i in range(nx):
            for j in range(ny):
                k = min(j + 1, last)  # of strips the same: they do not change in y
                xx = 0.5 / dx * (u[i + 1, j] + u[i + 1, k] - u[i, j] - u[i, k])
                yx = 0.5 / dx * (v[i + 1, j] + v[i + 1, k] - v[i, j] - v[i, k])
                xy = 0.5 / dy * (u[i, k] + u[i + 1, k] - u[i, j] - u[i + 1, j])
                yy = 0.5 / dy * (v[i, k] + v[i + 1, k] - v[i, j] - v[i + 1, j])
                p_x, p_y, p_n = _mean(p[0], i, j, k), _mean(p[1], i, j, k), _mean(p[2], i, j, k)
                out[b, 0, i, j] = plane * (xx + nu * yy) - by_pressure * p_n
                out[b, 1, i, j] = plane * (yy + nu * xx) - by_pressure * p_n
                out[b, 2, i, j] = -p_n
                out[b, 3, i, j] = xy + yx
                out[b, 4, i, j] = -p_x
                out[b, 5, i, j] = -p_y


@compiled
def _mean(field, i, j, k):
    return 0.25 * (field[i, j] + field[i + 1, j] + field[i, k] + field[i + 1, k])
