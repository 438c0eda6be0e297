"""An accuracy in place of a mesh: the scene on finer and finer meshes, and error bars.

Every mesh has half the elements of the next. `error_bars` estimates from the differences between
the last three meshes how far the finest is from the limit. The mesh is refined until the error bars
are within the tolerance.
"""
