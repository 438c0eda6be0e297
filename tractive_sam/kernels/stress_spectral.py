"""From spectra of packed integrals and of tractions to the spectra of six stresses.

Spectra of functions that are odd in x carry a factor -i, as do those odd in y: with real sums
ee, oe, eo, oo (see :mod:`tractive_sam.kernels.stress_lattice`) the spectra are ee, -i oe, -i eo and
-oo. The parity of a stress component is the product of the parities of its indices and its load.
"""

from tractive_sam.kernels.compiled import ANY_ORDER, compiled
from tractive_sam.kernels.stress import assemble_normal, assemble_shear_x, assemble_shear_y


@compiled(fastmath=ANY_ORDER)
def layer_product(out, packs, loads, sign, nu, first, last):
    """Set `out` to the spectra of six stresses in a plane z = const, in the rows +-i of a range.

    Parameters
    ----------
    out : ndarray of complex, shape (6, p_x, p_y/2 + 1)
        Spectra of the stresses, times 2 pi.
    packs : ndarray of complex, shape (4, p_x, p_y/2 + 1)
        Spectra of `stress_lattice.layer_table`.
    loads : ndarray of complex, shape (3, p_x, p_y/2 + 1)
        Spectra of (p_x, p_y, p_n).
    sign : float
        Factors of p_x and p_y.
    nu : float
        Poisson's ratio.
    first, last : int
        Part of range(p_x/2 + 1).
    """
    _, px, half = packs.shape
    for i in range(first, last):
        k = (px - i) % px
        for j in range(half):
            sums = _unpack_layer(packs, i, k, j)
            along_x, along_y = assemble_shear_x(sums, nu), assemble_shear_y(sums, nu)
            normal = assemble_normal(sums, nu)
            x, y, n = sign * loads[0, i, j], sign * loads[1, i, j], loads[2, i, j]
            # In the mirror x -> -x the sums of -k_x become the sums of k_x.
            mx, my, mn = -sign * loads[0, k, j], sign * loads[1, k, j], loads[2, k, j]
            s = _combine(along_x, along_y, normal, x, y, n)
            m = _combine(along_x, along_y, normal, mx, my, mn)
            out[0, i, j], out[0, k, j] = s[0], m[0]
            out[1, i, j], out[1, k, j] = s[1], m[1]
            out[2, i, j], out[2, k, j] = s[2], m[2]
            out[3, i, j], out[3, k, j] = s[3], -m[3]
            out[4, i, j], out[4, k, j] = s[4], -m[4]
            out[5, i, j], out[5, k, j] = s[5], m[5]


@compiled(fastmath=ANY_ORDER, inner=True)
def _unpack_layer(packs, i, k, j):
    """Return the real sums of the 14 integrals from packs at (k_x, k_y) and (-k_x, k_y)."""
    xxz, xxx, xxy, xyz = _split_parities(packs[0, i, j], packs[0, k, j])
    yyz, xyy, yyy, psi_xy = _split_parities(packs[1, i, j], packs[1, k, j])
    zzz, xzz, yzz, _ = _split_parities(packs[2, i, j], packs[2, k, j])
    psi_xx, chi_xyy, chi_xxy, _ = _split_parities(packs[3, i, j], packs[3, k, j])
    return xxx, xxy, xyy, yyy, xxz, xyz, yyz, xzz, yzz, zzz, psi_xx, psi_xy, chi_xxy, chi_xyy


@compiled(fastmath=ANY_ORDER, inner=True)
def _split_parities(a, b):
    """Return four real sums (ee, oe, eo, oo) from their two complex combinations a and b."""
    return (
        0.5 * (a.real + b.real),
        0.5 * (b.imag - a.imag),
        -0.5 * (a.imag + b.imag),
        0.5 * (b.real - a.real),
    )


@compiled(fastmath=ANY_ORDER, inner=True)
def _combine(along_x, along_y, normal, x, y, n):
    """Return the spectra of six stresses from factors and the spectra of tractions x, y and n."""
    ix, iy, i_n = _minus_i(x), _minus_i(y), _minus_i(n)
    return (
        along_x[0] * ix + along_y[0] * iy + normal[0] * n,
        along_x[1] * ix + along_y[1] * iy + normal[1] * n,
        along_x[2] * ix + along_y[2] * iy + normal[2] * n,
        along_x[3] * ix + along_y[3] * iy - normal[3] * n,
        along_x[4] * x - along_y[4] * y + normal[4] * i_n,
        along_y[5] * y - along_x[5] * x + normal[5] * i_n,
    )


@compiled(fastmath=ANY_ORDER, inner=True)
def _minus_i(z):
    """Return -i z of a complex number z."""
    return complex(z.imag, -z.real)


@compiled(fastmath=ANY_ORDER)
def plane_product(out, packs, loads, sign, nu):
    """Set `out` to the spectra of six stresses in a plane x = const, summed over patch edges.

    Parameters
    ----------
    out : ndarray of complex, shape (6, p_y/2 + 1)
        Spectra of the stresses, times 2 pi.
    packs : ndarray of complex, shape (8, edges, p_y/2 + 1)
        Spectra of `stress_lattice.edge_table`.
    loads : ndarray of complex, shape (2, 3, edges, p_y/2 + 1)
        Spectra of the jumps of (p_x, p_y, p_n) at the edges at the distance +-x of the plane: their
        sum, and their difference.
    sign : float
        Factors of p_x and p_y.
    nu : float
        Poisson's ratio.
    """
    out[:] = 0.0
    _, edges, half = packs.shape
    for e in range(edges):
        for j in range(half):
            sums = _unpack_edge(packs, e, j)
            along_x, along_y = assemble_shear_x(sums, nu), assemble_shear_y(sums, nu)
            normal = assemble_normal(sums, nu)
            # Across an edge the integrals odd in x are even, and the reverse.
            odd_x, odd_y, odd_n = (
                sign * loads[0, 0, e, j],
                sign * loads[0, 1, e, j],
                loads[0, 2, e, j],
            )
            x, y, n = sign * loads[1, 0, e, j], sign * loads[1, 1, e, j], loads[1, 2, e, j]
            for c in range(3):
                out[c, j] += along_x[c] * odd_x + along_y[c] * _minus_i(y) + normal[c] * n
            out[3, j] += along_x[3] * _minus_i(x) + along_y[3] * odd_y + normal[3] * _minus_i(odd_n)
            out[4, j] += along_x[4] * x + along_y[4] * _minus_i(odd_y) + normal[4] * odd_n
            out[5, j] += along_x[5] * _minus_i(odd_x) + along_y[5] * y + normal[5] * _minus_i(n)


@compiled(fastmath=ANY_ORDER, inner=True)
def _unpack_edge(packs, e, j):
    """Return the real sums of the 14 integrals across an edge from its packs at k_y."""
    xxz, xxy = packs[0, e, j].real, -packs[0, e, j].imag
    xxx, xyz = packs[1, e, j].real, -packs[1, e, j].imag
    yyz, yyy = packs[2, e, j].real, -packs[2, e, j].imag
    xyy, psi_xy = packs[3, e, j].real, -packs[3, e, j].imag
    zzz, yzz = packs[4, e, j].real, -packs[4, e, j].imag
    xzz = packs[5, e, j].real
    psi_xx, chi_xxy = packs[6, e, j].real, -packs[6, e, j].imag
    chi_xyy = packs[7, e, j].real
    return xxx, xxy, xyy, yyy, xxz, xyz, yyz, xzz, yzz, zzz, psi_xx, psi_xy, chi_xxy, chi_xyy
