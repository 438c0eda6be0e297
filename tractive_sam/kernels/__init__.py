"""Formulas on numbers and the loops over them, compiled by numba (which is imported only here)."""
