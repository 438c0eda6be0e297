"""An accuracy in place of a mesh: the same scene on finer and finer meshes, and error bars.

Every mesh has half the elements of the next. The differences between the last three tell how far
the finest may be from the limit (`error_bars`); it is refined until that is within the tolerance.
"""
