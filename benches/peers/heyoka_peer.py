"""heyoka, Taylor series of adaptive order and step size compiled for the scene, on scenes of the gallery.

In, on standard input: a JSON object with `scene`, `parameters` (by name), `q`, `v`, `t` (the end), `tolerances`, `repetitions`.
Out: one line per tolerance, `tolerance,microseconds,steps,q...,v...`; microseconds are the shortest of the repetitions, without
the compilation. Exit code 3: the scene is not known here.

The equations are those of index 1, eliminated symbolically: M a + G' lambda = F, G a = -gamma.

Source: F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614; https://bluescarni.github.io/heyoka.py
"""

import json
import sys
import time

import heyoka as hy

UNKNOWN_SCENE = 3


def squares(*terms):
    return sum(term * term for term in terms)


def double_pendulum(q, v, t, p):
    x1, y1, x2, y2 = q
    kinetic = 0.5 * p["m1"] * squares(*v[:2]) + 0.5 * p["m2"] * squares(*v[2:])
    rods = [squares(x1, y1) - p["l1"] ** 2, squares(x2 - x1, y2 - y1) - p["l2"] ** 2]
    return kinetic - p["g"] * (p["m1"] * y1 + p["m2"] * y2), rods


def double_pendulum_angles(q, v, t, p):
    inner, outer = p["l1"] * v[0], p["l2"] * v[1]
    masses = p["m1"] + p["m2"]
    kinetic = 0.5 * masses * inner**2 + 0.5 * p["m2"] * outer**2 + p["m2"] * inner * outer * hy.cos(q[0] - q[1])
    return kinetic + p["g"] * (masses * p["l1"] * hy.cos(q[0]) + p["m2"] * p["l2"] * hy.cos(q[1])), []


def pendulum(q, v, t, p):
    return p["m"] * p["l"] * (0.5 * p["l"] * v[0] ** 2 + p["g"] * hy.cos(q[0])), []


def pendulum_cartesian(q, v, t, p):
    return 0.5 * p["m"] * squares(*v) - p["m"] * p["g"] * q[-1], [squares(*q) - p["l"] ** 2]


def kapitza_pendulum(q, v, t, p):
    pivot = p["a"] * hy.cos(p["w"] * t)
    return 0.5 * p["m"] * squares(*v) - p["m"] * p["g"] * q[1], [squares(q[0], q[1] - pivot) - p["l"] ** 2]


def kepler(q, v, t, p):
    return 0.5 * p["m"] * squares(*v) + p["m"] * p["mu"] / hy.sqrt(squares(*q)), []


def henon_heiles(q, v, t, p):
    x, y = q
    return 0.5 * squares(*v) - 0.5 * squares(*q) - p["coupling"] * (x * x * y - y * y * y / 3.0), []


def stiff_spring_pendulum(q, v, t, p):
    stretch = hy.sqrt(squares(*q)) - p["l"]
    return 0.5 * p["m"] * squares(*v) - 0.5 * p["k"] * stretch**2 - p["m"] * p["g"] * q[1], []


def harmonic_oscillator(q, v, t, p):
    return 0.5 * p["m"] * v[0] ** 2 - 0.5 * p["k"] * q[0] ** 2, []


def fermi_pasta_ulam(q, v, t, p):
    x, y = q[:3], q[3:]
    soft = [x[0] - y[0], x[1] - y[1] - x[0] - y[0], x[2] - y[2] - x[1] - y[1], x[2] + y[2]]
    return 0.5 * squares(*v) - 0.5 * p["omega"] ** 2 * squares(*y) - 0.25 * sum(s**4 for s in soft), []


# Lagrangian and constraints as functions of (q, v, t, parameters); the largest step where series at the start see too few terms:
# from rest in symmetric positions every other derivative vanishes, and the first step would be far too long.
SCENES = {
    "double_pendulum": (double_pendulum, float("inf")),
    "double_pendulum_angles": (double_pendulum_angles, 0.05),
    "fermi_pasta_ulam": (fermi_pasta_ulam, float("inf")),
    "harmonic_oscillator": (harmonic_oscillator, float("inf")),
    "henon_heiles": (henon_heiles, float("inf")),
    "kapitza_pendulum": (kapitza_pendulum, float("inf")),
    "kepler": (kepler, float("inf")),
    "pendulum": (pendulum, float("inf")),
    "pendulum_cartesian": (pendulum_cartesian, float("inf")),
    "spherical_pendulum": (pendulum_cartesian, float("inf")),
    "stiff_spring_pendulum": (stiff_spring_pendulum, float("inf")),
}


def along(expression, q, v, clock):
    """The part of the derivative along the motion that has no accelerations in it."""
    terms = [hy.diff(expression, x) * rate for x, rate in zip(q, v)]
    return sum(terms, hy.diff(expression, clock))


def solved(matrix, columns):
    """Solutions of a symmetric positive definite system of expressions, by elimination without pivoting."""
    n = len(matrix)
    rows = [list(matrix[i]) + [column[i] for column in columns] for i in range(n)]
    for k in range(n):
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b if j > k else hy.expression(0.0) for j, (a, b) in enumerate(zip(rows[i], rows[k]))]
    solutions = []
    for column in range(n, n + len(columns)):
        x = [None] * n
        for i in reversed(range(n)):
            rest = rows[i][column] - sum((rows[i][k] * x[k] for k in range(i + 1, n)), hy.expression(0.0))
            x[i] = rest / rows[i][i]
        solutions.append(x)
    return solutions


def accelerations(lagrangian, constraints, q, v, clock):
    momenta = [hy.diff(lagrangian, rate) for rate in v]
    mass = [[hy.diff(p, rate) for rate in v] for p in momenta]
    force = [hy.diff(lagrangian, x) - along(p, q, v, clock) for x, p in zip(q, momenta)]
    gradients = [[hy.diff(phi, x) for x in q] for phi in constraints]
    rates = [along(phi, q, v, clock) for phi in constraints]
    free, *directions = solved(mass, [force, *gradients])
    if not constraints:
        return free
    dot = lambda a, b: sum((x * y for x, y in zip(a, b)), hy.expression(0.0))
    gram = [[dot(gradient, direction) for direction in directions] for gradient in gradients]
    leaving = [dot(gradient, free) + along(rate, q, v, clock) for gradient, rate in zip(gradients, rates)]
    (multipliers,) = solved(gram, [leaving])
    pull = [dot(multipliers, [direction[i] for direction in directions]) for i in range(len(q))]
    return [a - b for a, b in zip(free, pull)]


def main():
    request = json.load(sys.stdin)
    if request["scene"] not in SCENES:
        print(f"no equations for the scene {request['scene']}", file=sys.stderr)
        sys.exit(UNKNOWN_SCENE)
    equations, largest_step = SCENES[request["scene"]]
    n = len(request["q"])
    q = hy.make_vars(*[f"q{i}" for i in range(n)])
    v = hy.make_vars(*[f"v{i}" for i in range(n)])
    q, v = ([q], [v]) if n == 1 else (list(q), list(v))
    clock = hy.make_vars("clock")
    lagrangian, constraints = equations(q, v, clock, request["parameters"])
    right_sides = [*v, *accelerations(lagrangian, constraints, q, v, clock)]
    system = [(x, hy.subs(side, {clock: hy.time})) for x, side in zip([*q, *v], right_sides)]
    start = [*request["q"], *request["v"]]
    for tolerance in request["tolerances"]:
        integrator = hy.taylor_adaptive(system, start, time=0.0, tol=tolerance)
        shortest = float("inf")
        for _ in range(request["repetitions"]):
            integrator.time = 0.0
            integrator.state[:] = start
            clock_start = time.perf_counter_ns()
            outcome = integrator.propagate_until(request["t"], max_delta_t=largest_step)
            shortest = min(shortest, 1e-3 * (time.perf_counter_ns() - clock_start))
        if outcome[0] != hy.taylor_outcome.time_limit:
            sys.exit(f"stopped at t = {integrator.time}: {outcome[0]}")
        numbers = [tolerance, shortest, outcome[3], *integrator.state]
        print(",".join(repr(float(number)) for number in numbers), flush=True)


if __name__ == "__main__":
    main()
