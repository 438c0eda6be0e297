"""Names that `compute` exports, for `__init__.py` and for type checkers."""

from .backend import Array as Array
from .backend import Backend as Backend
from .backend import Places as Places
from .backends import backend_of as backend_of
from .convolution import Convolution as Convolution
from .memory import available_memory as available_memory
from .meter import ConvolutionMeter as ConvolutionMeter
from .threads import cores as cores
from .threads import single_blas_thread as single_blas_thread
