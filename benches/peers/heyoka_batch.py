"""heyoka's batch: many trajectories of a scene in the lanes of the machine's vectors.

In, on standard input: what `heyoka_peer.py` takes, but for `starts`, a list of [q, v] in the place of `q` and `v`. Out: one line per tolerance,
`tolerance,microseconds,batch,q...` with the positions at the end, trajectory by trajectory; microseconds are the sum over
all batches of the shortest of the repetitions, on one core, without the compilation.
"""

import json
import sys
import time

import heyoka as hy
import numpy as np
from heyoka_peer import SCENES, UNKNOWN_SCENE, accelerations


def main():
    request = json.load(sys.stdin)
    if request["scene"] not in SCENES:
        print(f"no equations for the scene {request['scene']}", file=sys.stderr)
        sys.exit(UNKNOWN_SCENE)
    equations, largest_step = SCENES[request["scene"]]
    n = len(request["starts"][0][0])
    q = list(hy.make_vars(*[f"q{i}" for i in range(n)]))
    v = list(hy.make_vars(*[f"v{i}" for i in range(n)]))
    clock = hy.make_vars("clock")
    lagrangian, constraints = equations(q, v, clock, request["parameters"])
    right_sides = [*v, *accelerations(lagrangian, constraints, q, v, clock)]
    system = [(x, hy.subs(side, {clock: hy.time})) for x, side in zip([*q, *v], right_sides)]
    batch = hy.recommended_simd_size()
    starts = np.array([[*q, *v] for q, v in request["starts"]])
    assert len(starts) % batch == 0, "whole batches"
    groups = [np.ascontiguousarray(starts[k : k + batch].T) for k in range(0, len(starts), batch)]
    for tolerance in request["tolerances"]:
        integrator = hy.taylor_adaptive_batch(system, groups[0].copy(), time=np.zeros(batch), tol=tolerance)
        ends, taken = [], 0.0
        for group in groups:
            shortest = float("inf")
            for _ in range(request["repetitions"]):
                integrator.set_time(np.zeros(batch))
                integrator.state[:] = group
                begin = time.perf_counter_ns()
                integrator.propagate_until(request["t"], max_delta_t=largest_step)
                shortest = min(shortest, 1e-3 * (time.perf_counter_ns() - begin))
            taken += shortest
            ends.append(integrator.state[:n].T.copy())
        if any(outcome[0] != hy.taylor_outcome.time_limit for outcome in integrator.propagate_res):
            sys.exit(f"stopped at t = {integrator.time}")
        numbers = [tolerance, taken, batch, *np.concatenate(ends).ravel()]
        print(",".join(repr(float(number)) for number in numbers), flush=True)


if __name__ == "__main__":
    main()
