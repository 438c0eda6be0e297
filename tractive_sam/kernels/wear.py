"""The upwind sweep of wear: material gathers depth from the leading edge to the trailing one."""

import numpy as np


def sweep_wear(entering, rate, dx):
    """Return the depth (n_x, n_y), mm: entering depth plus rate summed from the leading edge.

    Paper, eq. (32): w_I = w_entering + sum of rate_J dx over J from I up to the leading edge.

    Parameters
    ----------
    entering : ndarray, shape (n_y,)
        Depth with which the material enters, mm.
    rate : ndarray, shape (n_x, n_y)
        Wear per distance rolled, dimensionless.
    dx : float
        Side of an element in the rolling direction, mm.

    Returns
    -------
    ndarray, shape (n_x, n_y)
        Depth, mm; its row 0 is what leaves the contact.
    """
    return np.concatenate((entering[None], dx * rate[::-1])).cumsum(0)[:0:-1].copy()


def chart(speed, pressure, borders, limit, coefficients):
    """Return Archard's coefficient from a chart of sliding speed and pressure over hardness.

    Jendel (2002), Wear 253, 89-99: one regime below the first speed, one between both, one above;
    a fourth at any speed if the pressure exceeds a limit.

    Parameters
    ----------
    speed, pressure : ndarray
        Sliding speed, and pressure over hardness.
    borders : tuple of float
        The two speeds.
    limit : float
        Pressure over hardness.
    coefficients : tuple of float
        Coefficients of the four regimes.

    Returns
    -------
    ndarray
        k, dimensionless: worn volume times hardness over load and sliding distance.
    """
    regimes = pressure > limit, speed < borders[0], speed <= borders[1]
    return np.select(regimes, (coefficients[3], *coefficients[:2]), coefficients[2])
