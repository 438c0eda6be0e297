"""Names that `compute` exports, for `__init__.py` and for type checkers."""

from .backend import Array as Array
from .backend import Backend as Backend
from .backend import Mirror as Mirror
from .backend import Places as Places
from .convolution import Convolution as Convolution
from .convolution import MirroredConvolution as MirroredConvolution
from .convolution import backend_of as backend_of
from .fft import ConvolutionMeter as ConvolutionMeter
from .fft import LayerTransform as LayerTransform
from .fft import PlanCache as PlanCache
from .fft import box_transform as box_transform
from .fft import cores as cores
from .fft import edge_transform as edge_transform
from .fft import fast_length as fast_length
from .fft import layer_transform as layer_transform
from .fft import numeric_settings as numeric_settings
from .fft import padded_length as padded_length
from .fft import transform as transform
