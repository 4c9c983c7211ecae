"""MuJoCo on a hanging chain of point masses, at rest from the horizontal.

In, on standard input: a JSON object with `bodies`, `mass`, `length` (of each), `gravity`, `t` (the end), `steps` (numbers of steps),
`repetitions`. Out: one line per number of steps, `microseconds,steps,x1,y1,...`; microseconds are the shortest of the repetitions.

MuJoCo works in joint angles, a hinge per rod, with mass matrices by its composite-rigid-body algorithm. Of its integrators the
Runge-Kutta method of order 4 has the least error for its time here.

Source: E. Todorov, T. Erez, Y. Tassa, IROS 2012, 5026; https://mujoco.readthedocs.io
"""

import json
import sys
import time

import mujoco

# The least that MuJoCo admits for the moment of inertia of a point, less than round-off of `mass * length**2`.
INERTIA = 1.001e-15


def chain(bodies, mass, length, gravity, step):
    """The chain as a model: body inside of body."""
    opening, closing = [], []
    for index in range(bodies):
        place = 0.0 if index == 0 else length
        opening.append(
            f'<body pos="{place!r} 0 0"><joint type="hinge" axis="0 -1 0"/>'
            f'<inertial pos="{length!r} 0 0" mass="{mass!r}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>'
            f'<site name="end{index}" pos="{length!r} 0 0"/>'
        )
        closing.append("</body>")
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco>
        <compiler angle="radian"/>
        <option timestep="{step!r}" integrator="RK4" gravity="0 0 {-gravity!r}">
        <flag contact="disable" constraint="disable"/></option>
        <worldbody>{"".join(opening)}{"".join(closing)}</worldbody></mujoco>"""
    )


def run(request, steps):
    """Microseconds and the places of the points at the end."""
    model = chain(
        request["bodies"], request["mass"], request["length"], request["gravity"], request["t"] / steps
    )
    microseconds = float("inf")
    for _ in range(request["repetitions"]):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        begin = time.perf_counter()
        mujoco.mj_step(model, data, nstep=steps)
        microseconds = min(microseconds, 1e6 * (time.perf_counter() - begin))
    mujoco.mj_kinematics(model, data)
    return microseconds, data.site_xpos[:, [0, 2]].ravel()


def main():
    request = json.load(sys.stdin)
    for steps in request["steps"]:
        microseconds, places = run(request, steps)
        print(",".join(repr(float(number)) for number in [microseconds, steps, *places]), flush=True)


if __name__ == "__main__":
    main()
