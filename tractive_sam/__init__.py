"""Tractive rolling contact of elastic bodies: forces, stick and slip, and wear.

Steady rolling of two half-spaces with longitudinal, lateral and spin creepage, orthotropic friction
and wear, by FFT-accelerated semi-analytical methods; after Juliá & Rodríguez-Tembleque, Int. J.
Mech. Sci. 294 (2025) 110195.

    >>> import tractive_sam as ts
    >>> scene = ts.Scene.builtin("spheres")
    >>> contact = ts.solve(scene)
    >>> round(contact.Qx / contact.P, 3)
    0.259
    >>> discs = ts.Scene.builtin("twin-discs").with_set(["wear.revolutions=2", "wear.save=[0, 2]"])
    >>> history = ts.roll(discs)
    >>> history.status
    'done'

Each public name has a page, as ``help(ts.Scene)``, with an example that continues from here;
examples of `plot`, `subsurface` and `reference` also know the names of their package.

Names by topic
--------------
**Compute** solve, roll, solve_many, explain, study, explain_study, build_table

**Scene** Scene, Bodies, Body, BodyLayer, Stiffness, Relaxation, RollerProfile, Conformal, Load,
Creepage, Friction, Wear, Coefficients, WearLaws, Sets, Mesh, Accuracy, Gap, Solver, Subsurface,
Fatigue, FatigueVolume, Strength, LayerStrength, Residual, ResidualStress, Inclusion, Heat, Bulk,
Thermal; builtin_names

**Changing scenes** Transient, Stage, LoadCourse, CreepageCourse, FrictionCourse, Profiles; Block,
BlockLoad, BlockCreepage, BlockFriction, LoadHistory, Binned, blocks_of

**Wheel and rail** WheelTable, RailTable, Grinding, WheelsetTable, BlockWheelset; contact_locus,
wear_profiles, WornProfiles

**Processes** Process, Step, StepRecord, ProcessTable, Observer, ObserverTable

**Results** Contact, State, History, Quantity, PlaneStress, Maximum, FlashTemperature, BodyFatigue;
open_history, report, export_surface, export_volume

**Stress and fatigue** stress_at, stress_maximum, stress_on_plane, stress_on_planes, stress_path,
stress_volume, fatigue, around_inclusions, inclusion_lift

**Any file** open_any, Document

**Levels of the model** compare_levels, Levels

**Many scenes** Study, StudyResults, open_study; CreepTable, TableDesign, open_table, write_fmu

**Fits** fit, FitDesign, FitResult, open_fit, FitError

**Spreads** spread, SpreadDesign, SpreadResult, open_spread, SpreadError

**Designs** design, OptimumDesign, OptimumResult, open_design, DesignError

**Laws** Laws, FrictionLaw, Coulomb, FallingCoulomb, ScaledFriction, InterfacialLayer, Slope,
Bound, Elasticity, ElasticBodies, HalfSpaces, SpectralHalfSpaces, LinearHalfSpaces,
ConformalBodies, LayeredBody, Layer, Material, TransverseMaterial, AnisotropicHalfSpaces,
AnisotropicMaterial, RelaxingBody, RelaxingHalfSpaces, creep_terms; WearLaw, WearConditions,
Energy, PerBody, SlidingShare; StressCriterion, CycleCriterion, DangVan, Crossland, Findley,
FatemiSocie, OrthogonalShear, VolumeLife, Woehler, Steel; allow_laws

**Errors** SceneError, SceneWarning, NotConverged, GapError, ResultsError, StudyError, TableError

**Packages** plot, reference, solvers, studies, subsurface

Conventions, stated here once
-----------------------------
**Units** mm, N, MPa, revolutions; angles in degrees in a scene, radians inside; spin in 1/mm. If
both bodies have ``radius_y = inf`` they touch along a line, in plane strain: forces are then per
length, N/mm, moments N, and arrays have the shape (n_x, 1).

**Axes** x is the rolling direction, y lateral, z normal to the contact plane and into body A, the
upper one. Material crosses the contact from +x, the leading edge, to -x. Arrays have the shape
(n_x, n_y) of the grid, vectors (2, n_x, n_y).

**Signs** Pressure is positive. The traction (p_x, p_y) acts on body A; body B carries its
opposite. Displacement u = u_A - u_B; slip is the velocity of A relative to B over the rolling
speed, s_x/V = xi_x - phi y - du_x/dx and s_y/V = xi_y + phi x - du_y/dx. A negative longitudinal
creepage drives body A: Q_x > 0 (for dissimilar bodies: one below the creepage of free rolling).

**Friction** The tribological axes (e1, e2) are turned by the angle beta counter-clockwise from x.

**Threads** Transforms of meshes from about 400 x 400 elements on take up to four cores, others
one; the environment variable OMP_NUM_THREADS bounds them.

**Names** ``displacement_xz`` is u_x from p_z, and so for every influence coefficient. A trailing
``~`` in formulas marks the scaled tribological frame of `tractive_sam.mechanics.friction.Frame`.
"""

# Names, listed in __init__.pyi, are looked up when first used: reading results or printing help
# need not wait for the compilers and transforms that computing needs. What looks them up is loaded
# by then as well: the program must handle signals before anything else takes its time. There is no
# __all__: with it, help(tractive_sam) would print 14,000 lines, each class in full.
_RENAMED = {"EachBody": "PerBody", "Layered": "InterfacialLayer"}


def __getattr__(name: str):
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415

        return version("tractive-sam")
    if name.startswith("__"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .lazy_names import attach_names  # noqa: PLC0415

    lookup, _, _ = attach_names(__name__, __file__)
    if name in _RENAMED:
        from .lazy_names import with_renamed  # noqa: PLC0415

        lookup = with_renamed(__name__, lookup, _RENAMED)
    return lookup(name)


def __dir__() -> list[str]:
    from .lazy_names import attach_names  # noqa: PLC0415

    return attach_names(__name__, __file__)[2]
