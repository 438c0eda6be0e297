"""The packages of `extra_packages`, for type checkers."""

import pandas as pandas
import xarray as xarray
