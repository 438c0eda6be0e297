"""The front doors of a scene: solve, roll, resume, explain, export, and error bars."""
