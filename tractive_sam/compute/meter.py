"""Count all convolutions of a solve: what it costs beside its operator applications."""

from threading import local


class _TransformedPoints(local):
    """Count of FFT points (fields times padded elements) that this thread has transformed."""

    points = 0.0


_TRANSFORMED = _TransformedPoints()


def count_transform(fields: int, padded: tuple[int, int]) -> None:
    """Add one padded FFT of several fields, forward or backward, to the count of this thread."""
    _TRANSFORMED.points += fields * padded[0] * padded[1]


class ConvolutionMeter:
    """Counter of convolution work of this thread, in applications of the tangential operator.

    The unit is one application of the tangential operator on a mesh: two fields forward and two
    backward. A transform of fewer fields, or on a part of the mesh, counts by its share of points,
    whatever its precision. Operators, preconditioners, coarser meshes and heat are included.

    Parameters
    ----------
    padded : tuple of int
        Padded shape (p_x, p_y) of the mesh.
    """

    def __init__(self, padded: tuple[int, int]) -> None:
        self._unit = 4.0 * padded[0] * padded[1]
        self._before = _TRANSFORMED.points

    @property
    def convolutions(self) -> float:
        """Work since the creation, in applications of the tangential operator (four transforms)."""
        return (_TRANSFORMED.points - self._before) / self._unit
