"""The laws as objects: elastic bodies, friction, wear, and how stress is judged.

Formulas are in `tractive_sam.kernels` with their sources; the laws call them, and everything above
sees the laws only. Imports nothing of what is asked (`scene`) or solved.
"""
