"""Contact solves and time of the twin discs' wear over the tolerance, for each stepping.

`twin-discs` at beta = 0, the paper's mesh. The reference rolls every revolution, 1,000 of them or,
with `--full`, all 15,000 (some minutes). The paper's own scheme, Uzawa's iteration with wear in its
loop and the upwind slip, is timed over a few revolutions in the same run.
"""

import sys
from time import perf_counter

import numpy as np
from timing import show, write

import tractive_sam as ts

SAVED = (50, 250, 1000, 4000, 15000)
PAPER_REVOLUTIONS = 3


def discs(revolutions: int, *settings: str) -> ts.Scene:
    saved = [0, *(n for n in SAVED if n <= revolutions)]
    common = ["friction.angle=0", f"wear.revolutions={revolutions}", f"wear.save={saved}"]
    return ts.Scene.builtin("twin-discs").with_set([*common, *settings])


def timed(scene: ts.Scene) -> tuple[ts.History, float]:
    began = perf_counter()
    history = ts.roll(scene)
    assert history.finished, history.message
    return history, perf_counter() - began


def paper_seconds() -> float:
    """Seconds of one revolution by the paper's scheme."""
    settings = ('wear.stepping="every-revolution"', 'solver.method="uzawa"', 'solver.slip="upwind"')
    _, unworn = timed(discs(1, *settings))
    _, some = timed(discs(1 + PAPER_REVOLUTIONS, *settings))
    return (some - unworn) / PAPER_REVOLUTIONS


def main():
    last = 15000 if "--full" in sys.argv else 1000
    timed(discs(5))  # compiles and plans
    reference, seconds = timed(discs(last, 'wear.stepping="every-revolution"'))
    solves = int(reference.totals["contact_solves"])
    print(f"every revolution to {last}: {solves} contact solves, {seconds:.1f} s")
    paper = paper_seconds()
    print(f"the paper's scheme: {paper:.2f} s a revolution, {paper * 15000:.0f} s for 15,000")

    rows = []
    for tolerance in (1e-2, 3e-3, 1e-3, 3e-4, 1e-4):
        history, took = timed(discs(15000, f"wear.tolerance={tolerance}"))
        row = {
            "tolerance": tolerance,
            "solves": int(history.totals["contact_solves"]),
            "records": len(history),
            "seconds": took,
            "paper/this": paper * 15000 / took,
            "depth at 15000": float(history["wear_max"][-1]),
            "Qx/P": float(history["Qx_over_P"][-1]),
            "p_max": float(history["p_max"][-1]),
        }
        i = int(np.flatnonzero(history["revolution"] == last)[0])
        for name in ("wear_max", "Qx_over_P", "p_max"):
            row[f"{name} error at {last}"] = float(history[name][i] / reference[name][last] - 1)
        profile = history["wear_profile"][i] - reference["wear_profile"][last]
        row["profile error"] = float(np.abs(profile).max() / reference["wear_max"][last])
        rows.append(row)
    show("Adaptive jumps to 15,000 revolutions", rows)
    print(f"written: {write('wear', rows)}")


if __name__ == "__main__":
    main()
