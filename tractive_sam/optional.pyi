"""The packages of `optional`, for type checkers."""

import pandas as pandas
import xarray as xarray
