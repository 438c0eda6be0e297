"""Studies: many scenes on many cores and machines.

    >>> import tractive_sam as ts
    >>> study = ts.Study(
    ...     scene="spheres",
    ...     without=["subsurface"],
    ...     axis=[
    ...         {"key": "creepage.longitudinal", "start": -1e-3, "stop": -4e-3, "number": 2},
    ...         {"key": "friction.mu", "values": [0.2, 0.4]},
    ...     ],
    ... )
    >>> results = ts.study(study, "creep-forces", workers=0)  # 0: in this process
    >>> results.dataset()["Qx_over_P"].sel({"friction.mu": 0.2}).round(2).values
    array([0.09, 0.2 ])

The file of a study
-------------------
::

    title = "Creep forces"                 # optional
    scene = "spheres-orthotropic"          # a built-in name, a file, or [scene] with its tables
    without = ["subsurface"]               # optional: what to leave out of it
    set = ["solver.tolerance=1e-9"]        # optional: settings
    keep = "scalars"                       # optional: numbers of last records alone, in one file

    [[axis]]                               # every combination of the axes is a case
    key = "friction.angle"
    values = [0, 45, 90]

    [[axis]]                               # a range
    key = "load.normal"
    start = 100.0
    stop = 1000.0
    number = 4
    spacing = "logarithmic"                # or "linear", the default

    [[axis.zip]]                           # varies in step with load.normal
    key = "grid.half_length"
    values = [[0.2, 0.8], [0.3, 1.1], [0.4, 1.5], [0.5, 2.0]]

    [latin]                                # a Latin hypercube of 20 samples, times the axes
    number = 20
    seed = 1

    [[latin.variable]]
    key = "friction.mu"
    start = 0.1
    stop = 0.6

Processes and workers
---------------------
Cases run on processes of this machine, which open no port, or on the workers of any scheduler of
dask.distributed. These need this package, one thread each, and the folder of the study under one
name::

    dask scheduler                                         # says its address
    dask worker ADDRESS --nthreads 1 --nworkers 16         # on every machine
    tractive-sam study STUDY.toml -o DIR --scheduler ADDRESS

The nannies of ``dask worker`` hold BLAS to one thread; with ``--no-nanny``, set OMP_NUM_THREADS=1.
FFTW has one thread unless another number is set, and the compiled kernels have no others.
Under SLURM, dask-jobqueue (``pip install dask-jobqueue``) starts the workers as jobs::

    from dask_jobqueue import SLURMCluster

    cluster = SLURMCluster(
        cores=16,  # of a job
        processes=16,  # one thread each
        memory="32GB",  # of a job; tractive-sam explain prints what a worker takes
        walltime="12:00:00",
    )
    cluster.adapt(maximum_jobs=32)
    ts.study("STUDY.toml", "/shared/DIR", scheduler=cluster.scheduler_address)

A job that meets its walltime is a worker that dies: its cases continue in the next one.

Who may hand out work
---------------------
Whoever reaches the port of a scheduler or worker of dask.distributed can have it run any program in
your name: dask needs no password. Processes that this package starts have no port, but pipes. A
scheduler of your own listens to all interfaces by default, and so does its dashboard: start it with
``--host`` on a network that you trust and with ``--no-dashboard``, or with TLS, see
https://distributed.dask.org/en/stable/tls.html; its address then begins with ``tls://``, and the
keys are found by dask's configuration. A folder of results is safe to receive: reading one runs
nothing of it.

Processes of your own
---------------------
Scripts may compute in separate processes, started in any way: ``fork`` waits for plans of
transforms that other threads are making. With ``spawn``, the script needs ``if __name__ ==
"__main__":``.

Failures of workers and clients
-------------------------------
The state of a study is in its files (see `folder`), not in the scheduler. A case is complete when
its results file says so, and is then never run again. Running the study again resumes it, also with
other axes: cases are identified by the hash of their scenes. If a worker dies, its case passes to
another one and continues from its results file; one process at a time writes a file. A client that
loses its scheduler waits for it, or for another one at that address, for ten minutes; the workers
of a scheduler end with it, and have to be started again as well. If the client dies, cases that
have begun end on the workers of a scheduler, and the next client finds them; processes of this
machine end with their client, and the next one resumes their cases.
"""

from tractive_sam.lazy_names import attach_names, with_renamed

# Names, listed in __init__.pyi, are looked up when first used: a worker needs no figures, and
# whoever reads results no compilers.
_lookup, __dir__, __all__ = attach_names(__name__, __file__)
_RENAMED = {"Progress": "StudyProgress", "Row": "CaseRow"}
__getattr__ = with_renamed(__name__, _lookup, _RENAMED)
