"""Stability maps: measured and, if there is a theory, predicted limits of each method.

    python benchmarks/stability.py [uzawa coupling slip wear control]

`uzawa`: the longest step of Uzawa's iteration for several meshes and aspect ratios, the bound from
the eigenvalues of the slip operator in the contact, and the initial estimate of the solver.
`coupling`: iterations for pressure and tractions of dissimilar bodies against Dundurs' beta and
friction. `slip`: odd-even waves of the traction against the point at which the slip is evaluated.
`wear`: growth of a ripple in one jump with explicit, stabilised and implicit steps. `control`: cost
with a prescribed load and with the corresponding approach.

Page: docs/validation.md
"""

import sys
import warnings

import numpy as np
from hard_scenes import BUDGET, alternating, by_library, by_projection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from timing import RESULTS, show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.kernels.half_space import integrals
from tractive_sam.rolling.passage import first_passage, passage_at, wear_response
from tractive_sam.scene import Scene
from tractive_sam.solvers import Anderson, Problem
from tractive_sam.solvers.ladder import NORMAL
from tractive_sam.solvers.projection import ProjectedMap, slip_step

STEEL = {"young": 2e5, "poisson": 0.3}
FLAT = {"radius_x": np.inf, "radius_y": np.inf}


def ball(n: int, aspect: float = 1.0, **tables) -> Scene:
    """Return equal bodies with the aspect ratio a/b, on n x n elements, at 60 % of full slip."""
    scene = Scene(
        **{
            "body": {
                "A": STEEL | {"radius_x": 10.0, "radius_y": 10.0 * aspect**-1.5},
                "B": STEEL | FLAT,
            },
            "load": {"normal": 1e-2 * min(1.0, aspect**-3)},
            "friction": {"mu": 0.3},
            "solver": {"slip": "upwind"},
        }
        | tables
    )
    hertz = scene.hertz
    return scene.replace(
        **{
            "grid.half_length": (1.1 * hertz.a, 1.1 * hertz.b),
            "grid.elements": (n, n),
            "creepage.longitudinal": -0.6 * 0.3 * hertz.p0 / scene.material.shear,
        }
    )


def figure(columns: int, width: float = 4.6):
    picture = Figure(figsize=(width * columns, 3.8), layout="constrained")
    axes = np.atleast_1d(picture.subplots(1, columns))
    for axis in axes:
        axis.grid(alpha=0.3)
    return picture, axes


def finished(name: str, title: str, rows: list[dict], picture: Figure) -> None:
    picture.savefig(RESULTS / f"stability_{name}.png", dpi=150)
    show(title, rows)
    print(f"written: {write(f'stability_{name}', rows)} and its figure", flush=True)


# Uzawa's step


def longest_step(problem: Problem, over: float) -> float:
    """Return the longest step of Uzawa's iteration that does not diverge, by bisection."""
    solved = Anderson().solve(problem, 1e-9)
    nudge = 1e-6 * np.random.default_rng(0).normal(size=solved.traction.shape)
    low, high = 0.1 * over, 10.0 * over
    while high > 1.02 * low:
        step = np.sqrt(low * high)
        mapping = ProjectedMap(problem, np.full((2, 1, 1), step))
        state = mapping.admissible(solved.traction + nudge)
        for _ in range(600):
            evaluation = mapping(state)
            state = evaluation.image
        apart = np.linalg.norm(state - solved.traction)
        grown = apart > np.linalg.norm(
            mapping.admissible(solved.traction + nudge) - solved.traction
        )
        low, high = (low, step) if grown else (step, high)
    return low


def uzawa_step():
    """Map |1 - r l| < 1 for the eigenvalues l of the slip operator in stick, or on all elements.

    The first condition is necessary if no element changes its state; the second is sufficient.
    """
    rows = []
    for aspect in (0.2, 1.0, 5.0):
        for n in (11, 15, 21, 29, 41):
            model = Model(ball(n, aspect))
            problem = model.problem(model.undeformed_gap / model.units.gap)
            normal = NORMAL.solve(problem.normal, 1e-10)
            touching = normal.pressure > 0.0
            problem = problem.with_pressure(normal.pressure, normal.gap)
            bound = slip_step(model.operators, touching)
            row = {"n": n, "a/b": aspect, "estimate": bound}
            contact = equilibrium(model)
            for name, where in (
                ("eigenvalues, stick", contact.sticking),
                ("eigenvalues, all", touching),
            ):
                on = np.concatenate((where.ravel(), where.ravel()))
                matrix = model.operators.slip.as_matrix()[np.ix_(on, on)] if n <= 29 else None
                values = np.array([np.nan]) if matrix is None else np.linalg.eigvals(matrix)
                row[name] = float((2.0 * values.real / np.abs(values) ** 2).min())
            row["measured"] = longest_step(problem, 5.0 * bound)
            row["measured/estimate"] = row["measured"] / bound
            rows.append(row)
    picture, (axes,) = figure(1, 6.0)
    for aspect, colour in ((0.2, "C0"), (1.0, "C1"), (5.0, "C2")):
        mine = [row for row in rows if row["a/b"] == aspect]
        n = [row["n"] for row in mine]
        axes.loglog(n, [r["measured"] for r in mine], "o-", color=colour, label=f"a/b = {aspect:g}")
        axes.loglog(n, [r["eigenvalues, stick"] for r in mine], "x:", color=colour)
        axes.loglog(n, [r["eigenvalues, all"] for r in mine], "+:", color=colour)
        axes.loglog(n, [r["estimate"] for r in mine], "--", color=colour, lw=0.8)
    axes.plot([], [], "kx:", label="eigenvalues in stick")
    axes.plot([], [], "k+:", label="eigenvalues of the complete contact")
    axes.plot([], [], "k--", lw=0.8, label="estimate dx/A of the solver")
    axes.set(xlabel="elements a side", ylabel="longest step of the slip, dimensionless")
    axes.set_xticks([11, 15, 21, 29, 41], ["11", "15", "21", "29", "41"])
    axes.minorticks_off()
    axes.set_ylim(top=30.0)
    axes.legend(fontsize=8, ncols=2)
    finished("uzawa", "Longest step of Uzawa's iteration", rows, picture)


# Dissimilar bodies


def coupling():
    """Map bodies with Poisson's ratio 0 and beta = (1 - E_A/E_B)/(1 + E_A/E_B)/2.

    The cases are partial slip at a small creepage, and full slip at 10 mu p0/G. In full slip, the
    tractions are proportional to the pressure and cause a normal displacement of about beta mu
    times the displacement due to the pressure. This ratio is the factor by which an alternating
    iteration converges or diverges.
    """
    rows = []
    methods = {
        "alternating": alternating,
        "anderson": lambda s, m: by_projection(Anderson(iterations=BUDGET), s, m),
        "coupled": lambda s, m: by_library("newton", s, m),
    }
    betas, coefficients = (0.1, 0.2, 0.3, 0.4, 0.5), (0.03, 0.3, 1.0, 3.0, 10.0)
    for n, slips in ((11, False), (11, True), (21, False), (21, True)):
        for beta in betas:
            for mu in coefficients:
                compliant = STEEL | {"poisson": 0.0, "radius_x": 10.0, "radius_y": 10.0}
                ratio = (1.0 + 2.0 * beta) / max(1.0 - 2.0 * beta, 1e-9)
                stiff = {"young": 2e5 * ratio, "poisson": 0.0} | FLAT
                scene = ball(n, body={"A": compliant, "B": stiff}, friction={"mu": mu})
                full = -10.0 * mu * scene.hertz.p0 / scene.material.shear
                creepage = full if slips else -1e-4
                scene = scene.replace(**{"solver.slip": "auto", "creepage.longitudinal": creepage})
                row = {"n": n, "full slip": slips, "beta": beta, "mu": mu}
                for name, solve in methods.items():
                    solved, _, cost, *_ = solve(scene, Model(scene))
                    row[name] = round(cost) if solved else np.inf
                rows.append(row)
    picture = Figure(figsize=(11.0, 6.4), layout="constrained")
    axes = picture.subplots(2, 3, sharex=True, sharey=True)
    for line, slips in zip(axes, (False, True), strict=True):
        shown = [row for row in rows if row["n"] == 21 and row["full slip"] == slips]
        for panel, name in zip(line, methods, strict=True):
            costs = np.array([row[name] for row in shown]).reshape(len(betas), -1)
            image = panel.imshow(
                np.where(np.isfinite(costs), costs, np.nan),
                origin="lower",
                aspect="auto",
                norm=LogNorm(30, 3000),
            )
            for i, j in zip(*np.nonzero(~np.isfinite(costs)), strict=True):
                panel.text(j, i, "fails", ha="center", va="center", fontsize=8, color="C3")
            panel.set_title(f"{name}, {'full slip' if slips else 'stick and slip'}", fontsize=10)
            panel.set_xticks(range(len(coefficients)), [f"{mu:g}" for mu in coefficients])
            panel.set_yticks(range(len(betas)), [f"{beta:g}" for beta in betas])
    picture.supxlabel("mu")
    picture.supylabel("Dundurs' beta")
    picture.colorbar(image, ax=axes, label="applications to 1e-8, 21 x 21")
    finished(
        "coupling", "Dissimilar bodies: applications to 1e-8, inf after a failure", rows, picture
    )


# Odd-even waves


def _difference(offset: float, n: int) -> np.ndarray:
    """Return the slip of n x n unit elements at a point ahead of their centres, with G = 1."""
    nu, out = 0.3, np.empty((2, 2 * n - 1, 2 * n - 1, 2, 2))
    for side in (0, 1):
        for i in range(2 * n - 1):
            for j in range(2 * n - 1):
                x = i - n + 1 + offset + side - 0.5
                r, xx, yy, xy, *_ = integrals(x, j - n + 1.0, 1.0, 1.0)
                out[side, i, j] = [
                    [(1 - nu) * r + nu * xx, nu * xy],
                    [nu * xy, (1 - nu) * r + nu * yy],
                ]
    table = (out[0] - out[1]) / np.pi
    apart = np.arange(n)[:, None] - np.arange(n) + n - 1
    blocks = table[apart[:, :, None, None], apart[None, None]]  # i, k, j, l, 2, 2
    return blocks.transpose(4, 0, 2, 5, 1, 3).reshape(2 * n * n, 2 * n * n)


def odd_even(field: np.ndarray, inside: np.ndarray) -> float:
    """Return the share of waves of two elements in x in a field of shape (2, n_x, n_y)."""
    waves = (field[:, :-2] - 2.0 * field[:, 1:-1] + field[:, 2:]) / 4.0
    return float(
        np.linalg.norm(waves[:, inside[1:-1]]) / np.linalg.norm(field[:, 1:-1][:, inside[1:-1]])
    )


def slip():
    """Map full stick on a disc against the point of the slip, in elements ahead of the centres."""
    n = 19
    x = np.arange(n) - 0.5 * (n - 1)
    radius = np.hypot(x[:, None], x[None, :])
    disc, inside = radius < 0.5 * n, radius < 0.3 * n
    on = np.concatenate((disc.ravel(), disc.ravel()))
    rows = []
    for offset in (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.375, 0.45, 0.5):
        matrix = _difference(offset, n)[np.ix_(on, on)]
        row = {"offset": offset, "condition": float(np.linalg.cond(matrix))}
        ahead = np.broadcast_to((x + offset)[:, None], (n, n))
        aside = np.broadcast_to(x[None, :], (n, n))
        ones, zeros = np.ones((n, n)), np.zeros((n, n))
        rigid = {
            "x": (ones, zeros),
            "y": (zeros, ones),
            "45": (ones, ones),
            "spin": (-aside, ahead),
        }
        for name, field in rigid.items():
            traction = np.zeros((2, n, n))
            traction.reshape(-1)[on] = np.linalg.solve(matrix, -np.stack(field).ravel()[on])
            row[f"odd-even, {name}"] = odd_even(traction, inside)
        rows.append(row)
    solved = []
    for scheme in ("upwind", "auto"):
        for spin in (0.0, 1.0):
            for angle in (0.0, 30.0, 60.0, 90.0):
                scene = ball(41)
                size = scene.creepage.longitudinal
                changes = {
                    "solver.slip": scheme,
                    "creepage.longitudinal": size * np.cos(np.deg2rad(angle)),
                    "creepage.lateral": size * np.sin(np.deg2rad(angle)),
                    "creepage.spin": spin * abs(size) / scene.hertz.a,
                }
                contact = equilibrium(Model(scene.replace(**changes)))
                inner = np.hypot(*np.meshgrid(contact.grid.x, contact.grid.y, indexing="ij"))
                solved.append(
                    {
                        "scheme": scheme,
                        "direction": angle,
                        "spin a/creepage": spin,
                        "odd-even": odd_even(contact.traction, inner < 0.8 * scene.hertz.a),
                        "applications": contact.cost.applications + contact.cost.preconditioner,
                    }
                )
    picture, (left, right) = figure(2)
    offsets = [row["offset"] for row in rows]
    for name in ("x", "y", "45", "spin"):
        left.semilogy(offsets, [row[f"odd-even, {name}"] for row in rows], "o-", label=name)
    left.set(xlabel="point of the slip, elements ahead", ylabel="odd-even share, full stick")
    left.set_ylim(1e-3, 2.0)
    left.legend(fontsize=8, title="creepage along")
    for scheme, marker in (("upwind", "s"), ("auto", "o")):
        for spin, style in ((0.0, "-"), (1.0, ":")):
            mine = [s for s in solved if s["scheme"] == scheme and s["spin a/creepage"] == spin]
            label = scheme + (", spin" if spin else "")
            right.plot(
                [s["direction"] for s in mine],
                [s["odd-even"] for s in mine],
                marker + style,
                label=label,
            )
    right.set(xlabel="direction of creepage, degrees", ylabel="odd-even share, stick and slip")
    right.set_ylim(0.0)
    right.legend(fontsize=8)
    show("Stick and slip, 41 x 41", solved)
    write("stability_slip_schemes", solved)
    finished("slip", "Full stick over the point of the slip", rows, picture)


# Wear steps


def _stages(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Damped Runge-Kutta-Chebyshev method of first order (Verwer 1996, Appl. Numer. Math. 22)."""
    w0 = 1.0 + 0.05 / count**2
    t, dt, ddt = [1.0, w0], [0.0, 1.0], [0.0, 0.0]
    for _ in range(2, count + 1):
        ddt.append(2.0 * (2.0 * dt[-1] + w0 * ddt[-1]) - ddt[-2])
        dt.append(2.0 * (t[-1] + w0 * dt[-1]) - dt[-2])
        t.append(2.0 * w0 * t[-1] - t[-2])
    w1 = t[-1] / dt[-1]
    return np.array(t), w0, w1


def explicit(rate, profile, jump, response):
    return profile + jump * rate(profile)


def stabilised(rate, profile, jump, response, count=5):
    """Advance by a step that is stable to about g jump = 2 count².

    Its waves are damped by only 5 %.
    """
    t, w0, w1 = _stages(count)
    before, current = profile, profile + jump * w1 / w0 * rate(profile)
    for j in range(2, count + 1):
        mu, nu = 2.0 * w0 * t[j - 1] / t[j], -t[j - 2] / t[j]
        gain = 2.0 * w1 * t[j - 1] / t[j]
        ahead = (1.0 - mu - nu) * profile + mu * current + nu * before + gain * jump * rate(current)
        before, current = current, ahead
    return current


def implicit(rate, profile, jump, response):
    """Advance by a linearly implicit Euler step with the approximate response of the package."""
    system = np.eye(profile.size) / jump - response
    return profile + np.linalg.solve(system, rate(profile))


STEPS = {"explicit": explicit, "stabilised": stabilised, "implicit": implicit}


def polynomial(count: int, z: np.ndarray) -> np.ndarray:
    t, w0, w1 = _stages(count)
    return np.cosh(count * np.arccosh((w0 + w1 * z).astype(complex))).real / t[count]


def wear():
    """Map the ratio of a ripple after and before a jump; theory: half-space in full contact."""
    rows = []
    for elements in (41, 81):
        mesh = [f"grid.elements=[21, {elements}]", "grid.half_length=[0.35, 0.9]"]
        scene = Scene.builtin("twin-discs").with_set(
            [*mesh, "friction.mu=0.3", "wear.intensity=2e-6", "creepage.longitudinal=-0.02"]
        )
        model = Model(scene)
        first = first_passage(model)
        y, hertz = model.grid.y, scene.hertz

        def rate(profile, model=model, first=first):
            return passage_at(model, 1, profile, first.contact, 1e-7).worn

        flat = np.zeros(y.size)
        response = wear_response(model, first.contact)
        middle = np.abs(y) < 0.35 * hertz.b
        for waves in (elements // 10, elements // 5):
            number = np.pi * waves / 0.9
            shape = 1e-6 * np.cos(number * y) * np.clip(2.0 - 2.0 * np.abs(y) / hertz.b, 0.0, 1.0)

            def remaining_share(after, base, shape=shape, middle=middle):
                return float(((after - base) * shape)[middle].sum() / (shape**2)[middle].sum())

            ripple = shape
            measured = -remaining_share(rate(ripple), rate(flat))
            # i s/V of full slip over 2 a, of a pressure that answers by E* q/2.
            centre = y.size // 2
            chord = model.grid.dx * np.count_nonzero(first.contact.touching[:, centre])
            slipped = np.hypot(*first.contact.slip)[
                first.contact.touching[:, centre], centre
            ].mean()
            theory = 2e-6 * slipped * chord * scene.material.E_star * number / 2.0
            for times in (0.25, 1.0, 1.9, 4.0, 16.0, 40.0, 100.0):
                jump = times / theory
                row = {
                    "elements": elements,
                    "wave number": number,
                    "g": measured,
                    "g, theory": theory,
                }
                row["g jump, theory"] = times
                for name, step in STEPS.items():
                    after, base = (step(rate, p, jump, response) for p in (ripple, flat))
                    row[name] = remaining_share(after, base)
                rows.append(row)
    picture, (axes,) = figure(1, 6.5)
    z = np.geomspace(0.2, 110.0, 400)
    theory = {
        "explicit": np.abs(1.0 - z),
        "stabilised": np.abs(polynomial(5, -z)),
        "implicit": 1.0 / (1.0 + z),
    }
    for (name, curve), colour in zip(theory.items(), ("C3", "C0", "C2"), strict=True):
        axes.loglog(z, curve, "-", color=colour, lw=0.9, label=f"{name}, theory")
        measured = [abs(row[name]) for row in rows]
        axes.loglog(
            [r["g jump, theory"] for r in rows], measured, "o", ms=4, color=colour, label=name
        )
    axes.axhline(1.0, color="k", lw=0.6)
    axes.set(
        xlabel="gain per revolution in theory x revolutions of the jump",
        ylabel="ripple after/before",
    )
    axes.set_ylim(3e-3, 300.0)
    axes.legend(fontsize=8, ncols=2)
    finished("wear", "Ripple after a jump over before", rows, picture)


# Load or approach


def control():
    """Compare contacts under a load and under the corresponding approach, down to few elements."""
    rows = []
    for kind in ("equal", "dissimilar"):
        for n in (15, 31):
            for share in (1.0, 0.1, 0.01, 1e-3):
                scene = ball(n)
                load = share * scene.load.normal
                scene = scene.replace(**{"load.normal": load})
                if kind == "dissimilar":
                    changes = {"body.B.young": 1e7, "body.B.poisson": 0.0}
                    scene = scene.replace(**changes)
                reference = equilibrium(Model(scene))
                at_approach = scene.replace(**{"load.approach": reference.approach})
                touching = int(np.count_nonzero(reference.touching))
                row = {"bodies": kind, "n": n, "load": load, "in contact": touching}
                for method in ("newton", "anderson"):
                    for name, controlled in (("load", scene), ("approach", at_approach)):
                        contact = equilibrium(
                            Model(controlled.replace(**{"solver.method": method}))
                        )
                        cost = contact.cost.applications + contact.cost.preconditioner
                        row[f"{method}, {name}"] = round(cost) if contact.converged else np.inf
                        if method == "newton" and name == "approach":
                            row["loads differ by"] = abs(contact.P / load - 1.0)
                rows.append(row)
    picture, axes = figure(2)
    for panel, kind in zip(axes, ("equal", "dissimilar"), strict=True):
        for method, colour in (("newton", "C0"), ("anderson", "C1")):
            for name, style in (("load", "o-"), ("approach", "s:")):
                mine = sorted(
                    (r["in contact"], r[f"{method}, {name}"]) for r in rows if r["bodies"] == kind
                )
                label = f"{method}, given {name}"
                panel.loglog(*zip(*mine, strict=True), style, color=colour, label=label, ms=4)
        panel.set(title=f"{kind} bodies", xlabel="elements in contact")
        panel.set_ylabel("applications to 1e-8")
        panel.legend(fontsize=8)
    finished("control", "Load against approach", rows, picture)


MAPS = {"uzawa": uzawa_step, "coupling": coupling, "slip": slip, "wear": wear, "control": control}


def main():
    warnings.simplefilter("ignore")  # of coarse meshes
    for name in sys.argv[1:] or MAPS:
        MAPS[name]()


if __name__ == "__main__":
    main()
