"""Formulas on numbers and loops over elements, compiled by numba."""
