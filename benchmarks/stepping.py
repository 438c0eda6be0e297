"""Contact solves and time of the twin discs' wear against the tolerance, for each stepping scheme.

The profile E of the entering material satisfies E(n + 1) = E(n) + R(E(n)). Every scheme here is of
second order for the sum over the revolutions. The scheme of the package uses the profile halfway
through a revolution (`tractive_sam.rolling.revolutions`); the others use dE/dn = R - J R / 2. All
use one step control. The scene is `twin-discs` at beta = 0 over 15,000 revolutions, on the mesh of
the paper:

- Heun: explicit, second order, error estimate by Euler;
- RKC: Runge-Kutta-Chebyshev, stabilised explicit of second order with as many stages as the jump
  needs (Sommeijer, Shampine & Verwer 1998, J. Comput. Appl. Math. 88, 315-326);
- ROS2: linearly implicit of second order for any approximation of the Jacobian, a W-method (Verwer,
  Spee, Blom & Hundsdorfer 1999, SIAM J. Sci. Comput. 20, 1456-1480), with the response of the
  package;
- adaptive: the scheme of the package, which integrates the rows of elements over each jump.

The reference is the run that computes every revolution (`benchmarks/references`; about ten minutes
the first time). Seconds are CPU seconds of the process, on one thread.

Page: docs/benchmarks.md
"""

from collections.abc import Callable
from dataclasses import dataclass
from time import process_time

import numpy as np
from discs import SAVED, discs, errors, every_revolution, roughness, timed
from matplotlib.figure import Figure
from timing import RESULTS, show, write

from tractive_sam.contact import Model
from tractive_sam.results.history import History
from tractive_sam.results.record import Record
from tractive_sam.rolling.passage import (
    Passage,
    first_passage,
    next_passage,
    passage_at,
    wear_response,
)

TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 2.0
LAG = 0.3
MAX_SOLVES = 2500


class RefusedError(Exception):
    """A contact of a jump has no solution, or does not fit the mesh."""


@dataclass
class Course:
    """Position of a stepping, its cost, and the rate dE/dn of any profile."""

    model: Model
    passage: Passage
    solves: int

    @property
    def lag(self) -> float:
        scene = self.model.scene
        return max(LAG * scene.wear.tolerance, scene.solver.tolerance)

    def visit(self, profile: np.ndarray, revolution: int) -> tuple[np.ndarray, Passage]:
        """Return the rate at a profile, and the passage from which it follows."""
        passage = passage_at(self.model, revolution, profile, self.passage.contact, self.lag)
        self.solves += passage.solves
        if not passage.contact.converged:
            raise RefusedError(passage.contact.message)
        return self._rate(passage), passage

    def _rate(self, passage: Passage) -> np.ndarray:
        return passage.worn - 0.5 * wear_response(self.model, passage.contact) @ passage.worn

    def here(self) -> tuple[np.ndarray, np.ndarray]:
        """The profile and its rate."""
        return self.passage.entering, self._rate(self.passage)


Step = Callable[[Course, int], tuple[np.ndarray, np.ndarray]]
"""Maps a course and a jump to the final profile and an estimate of its error."""


def heun(course: Course, jump: int) -> tuple[np.ndarray, np.ndarray]:
    profile, rate = course.here()
    euler = profile + jump * rate
    rate_ahead, _ = course.visit(euler, course.passage.revolution + jump)
    return profile + 0.5 * jump * (rate + rate_ahead), 0.5 * jump * (rate_ahead - rate)


def chebyshev(course: Course, jump: int) -> tuple[np.ndarray, np.ndarray]:
    """Advance with as many stages as the jump needs, damped by 2/13; estimate the error."""
    profile, rate = course.here()
    radius = np.abs(np.linalg.eigvals(wear_response(course.model, course.passage.contact))).max()
    stages = max(2, 1 + int(np.sqrt(1.0 + 1.54 * jump * radius)))
    w0 = 1.0 + 2.0 / 13.0 / stages**2
    T = np.polynomial.Chebyshev.basis
    value = np.array([T(j)(w0) for j in range(stages + 1)])
    slope = np.array([T(j).deriv()(w0) for j in range(stages + 1)])
    curve = np.array([T(j).deriv(2)(w0) for j in range(stages + 1)])
    b = np.empty(stages + 1)
    b[2:] = curve[2:] / slope[2:] ** 2
    b[:2] = b[2]
    a = 1.0 - b * value
    w1 = slope[-1] / curve[-1]
    before, current = profile, profile + b[1] * w1 * jump * rate
    for j in range(2, stages + 1):
        mu, nu = 2.0 * b[j] * w0 / b[j - 1], -b[j] / b[j - 2]
        step = 2.0 * b[j] * w1 / b[j - 1] * jump
        rate_ahead, _ = course.visit(current, course.passage.revolution + jump)
        following = (1.0 - mu - nu) * profile + mu * current + nu * before
        following += step * (rate_ahead - a[j - 1] * rate)
        before, current = current, following
    rate_ahead, _ = course.visit(current, course.passage.revolution + jump)
    return current, 0.8 * (profile - current) + 0.4 * jump * (rate + rate_ahead)


def rosenbrock(course: Course, jump: int) -> tuple[np.ndarray, np.ndarray]:
    """Advance with two stages, gamma = 1 + 1/sqrt(2); the first stage estimates the error."""
    profile, rate = course.here()
    gamma = 1.0 + np.sqrt(0.5)
    response = wear_response(course.model, course.passage.contact)
    system = np.eye(profile.size) - gamma * jump * response
    first = np.linalg.solve(system, rate)
    rate_ahead, _ = course.visit(
        np.maximum(profile + jump * first, profile), course.passage.revolution + jump
    )
    second = np.linalg.solve(system, rate_ahead - 2.0 * first)
    return profile + jump * (1.5 * first + 0.5 * second), 0.5 * jump * (first + second)


STEPPINGS: dict[str, Step] = {"Heun": heun, "RKC": chebyshev, "ROS2": rosenbrock}


def rolled(step: Step, tolerance: float) -> tuple[History, Course, float]:
    """Compute the discs in jumps; the records are the saved revolutions."""
    began = process_time()
    model = Model(discs(SAVED[-1], f"wear.tolerance={tolerance}"))
    first = next_passage(model, first_passage(model))
    course = Course(model, first, 1 + first.solves)
    records, jump = [], 1
    while course.passage.revolution < SAVED[-1] and course.solves < MAX_SOLVES:
        revolution = course.passage.revolution
        distance = next(n for n in SAVED if n > revolution) - revolution
        taken = min(jump, distance)
        change = _advance(course, step, taken, tolerance)
        jump = max(1, int(max(taken * change, jump if change > 1.0 and taken < jump else 0)))
        if course.passage.revolution in SAVED and course.passage.revolution > revolution:
            process_values = {"revolution": course.passage.revolution}
            records.append(Record.from_contact(course.passage.contact, process_values))
    seconds = process_time() - began
    return History.of_records(records, model.scene, model.grid), course, seconds


def _advance(course: Course, step: Step, jump: int, tolerance: float) -> float:
    """Try a jump, and return the factor for the length of the next jump."""
    entering = course.passage.entering
    try:
        profile, missed = step(course, jump)
        profile = np.maximum(profile, entering)
        error = np.abs(missed).max() / max(profile.max(), 1e-9) / tolerance
        if error <= 1.0 or jump == 1:
            _, course.passage = course.visit(profile, course.passage.revolution + jump)
    except RefusedError:
        return SHORTEST_CUT
    return float(np.clip(SAFETY / np.sqrt(max(error, 1e-6)), SHORTEST_CUT, LONGEST_GROWTH))


def row(name: str, tolerance: float, solves: int, seconds: float, history, reference) -> dict:
    """Return a line of the table; for a stopped scheme, the line of its last saved revolution."""
    last = int(history["revolution"][-1])
    errors_of_row = errors(history, reference, last)
    return {
        "stepping": name,
        "tolerance": tolerance,
        "to revolution": last,
        "solves": solves,
        "seconds": round(seconds, 2),
        **{f"{name} error": error for name, error in errors_of_row.items()},
        "ripple": roughness(np.asarray(history.field("pressure", last))),
    }


def main():
    timed(discs(5))  # compiles and plans
    reference = every_revolution(SAVED[-1])
    totals = reference.totals
    rows = [
        row(
            "every revolution",
            0.0,
            int(totals["contact_solves"]),
            totals["wall_seconds"],
            reference,
            reference,
        )
    ]
    for tolerance in TOLERANCES:
        history, seconds = timed(discs(SAVED[-1], f"wear.tolerance={tolerance}"))
        solves = int(history.totals["contact_solves"])
        rows.append(row("adaptive", tolerance, solves, seconds, history, reference))
        for name, step in STEPPINGS.items():
            history, course, seconds = rolled(step, tolerance)
            rows.append(row(name, tolerance, course.solves, seconds, history, reference))
        show(f"Twin discs to 15,000 revolutions, tolerance {tolerance:g}", rows[-4:])
    print(f"written: {write('stepping', rows)}, {draw(rows)}")


def draw(rows):
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.subplots()
    for name, style in {"adaptive": "o-", "ROS2": "s-", "RKC": "^-", "Heun": "v-"}.items():
        mine = [r for r in rows if r["stepping"] == name and r["to revolution"] == SAVED[-1]]
        solves, missed = [r["solves"] for r in mine], [r["profile error"] for r in mine]
        axes.loglog(solves, missed, style, label=name)
    axes.set(
        xlabel="contact solutions to 15,000 revolutions", ylabel="error of the profile / depth"
    )
    axes.grid(alpha=0.3)
    axes.legend()
    path = RESULTS / "stepping.png"
    figure.savefig(path, dpi=150)
    return path


if __name__ == "__main__":
    main()
