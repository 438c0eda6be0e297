"""Count all convolutions of a solve: what it costs beside its operator applications."""

from threading import local
from time import process_time


class _Transformed(local):
    """FFT points (fields times padded elements) that this thread has transformed.

    Attributes
    ----------
    points : float
        Number of points.
    timed, seconds : float
        Points of convolutions in double precision, and the CPU time of these convolutions.
    """

    points = timed = seconds = 0.0


_TRANSFORMED = _Transformed()


def count_transform(fields: int, padded: tuple[int, int]) -> None:
    """Add one padded FFT of several fields, forward or backward, to the count of this thread."""
    _TRANSFORMED.points += fields * padded[0] * padded[1]


def count_time(fields: int, padded: tuple[int, int], began: float) -> None:
    """Add the CPU time since `began` to the time of convolutions in double precision."""
    _TRANSFORMED.timed += 2 * fields * padded[0] * padded[1]
    _TRANSFORMED.seconds += process_time() - began


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
        self._before, self._began = _TRANSFORMED.points, process_time()
        self._timed, self._seconds = _TRANSFORMED.timed, _TRANSFORMED.seconds

    @property
    def convolutions(self) -> float:
        """Work since the creation, in applications of the tangential operator (four transforms)."""
        return (_TRANSFORMED.points - self._before) / self._unit

    @property
    def over_application(self) -> float:
        """CPU time since the creation over the CPU time of one tangential application, or nan.

        The time of an application follows from the points of convolutions in double precision since
        then; nan means that there were none, or that the clock is too coarse to time them.
        """
        timed, seconds = _TRANSFORMED.timed - self._timed, _TRANSFORMED.seconds - self._seconds
        application = seconds * self._unit / timed if seconds > 0.0 else float("nan")
        return (process_time() - self._began) / application

    @property
    def work(self) -> dict[str, float]:
        """Both measures by the names of their attributes in `results.Cost`."""
        return {"convolutions": self.convolutions, "over_application": self.over_application}
