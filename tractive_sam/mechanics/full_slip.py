"""Full slip with orthotropic friction: the friction force, and the load that a force needs.

Friction coefficients mu1, mu2 belong to the tribological axes e1, e2, which are turned by
`angle` counter-clockwise from x, y. Angles in radians.
"""

import numpy as np

from tractive_sam.mechanics.frame import Frame

Pair = tuple[float, float]


def full_slip_force(load: float, mu: Pair, angle: float, slip: Pair) -> Pair:
    """Return the friction force (Q_x, Q_y) on body A, N, if the complete contact slips one way.

    The associated sliding rule Q = -P M² s / ||s||* with ||s||* = |M s| in tribological axes.
    Source: Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195, eqs. (10), (15).
    For slip along x its size is P sqrt(mu1² cos² angle + mu2² sin² angle) in x, which is also the
    largest Q_x that friction can carry at any Q_y.

    Parameters
    ----------
    load : float
        Normal load P, N.
    mu : (float, float)
        Friction coefficients mu1, mu2.
    angle : float
        Angle from x to e1, radians.
    slip : (float, float)
        Slip (s_x, s_y) of A over B; only its direction counts.

    Returns
    -------
    (float, float)
        Q_x, Q_y, N.

    Raises
    ------
    ValueError
        If the slip is zero: its direction is unknown.

    Examples
    --------
    >>> Q_x, Q_y = full_slip_force(300.0, (0.6, 0.3), np.pi / 4, slip=(-0.005, 0.0))
    >>> round(Q_x, 2), round(Q_y, 2)
    (142.3, 85.38)
    """
    frame = Frame(mu, angle)
    norm = float(frame.dual_norm(np.array(slip)))
    if not norm > 0:
        raise ValueError("the slip must not be zero: it gives the direction of sliding")
    Q_x, Q_y = frame.to_physical(-load / norm * frame.slip_to_scaled(np.array(slip)))
    return float(Q_x), float(Q_y)


def load_to_carry(force: Pair, mu: Pair, angle: float) -> float:
    """Return the smallest normal load under which friction carries the force (Q_x, Q_y), N.

    The elliptic norm sqrt((Q_e1/mu1)² + (Q_e2/mu2)²) of eq. (10), inverse to `full_slip_force`.

    Examples
    --------
    >>> round(load_to_carry((90.0, 0.0), (0.6, 0.3), angle=0.0), 9)
    150.0
    """
    return float(Frame(mu, angle).norm(np.array(force)))
