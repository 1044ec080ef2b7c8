"""Run: .venv/bin/python examples/10_distances.py        Twin: 10_distances.cpp.

The gripper goes round a post to a goal behind it, then to one close to the base. Told of the post and of
its own shape, the robot keeps the margin; not told, it would go through both.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")  # with its spheres
robot.position_lower[:3], robot.position_upper[:3] = -0.15, 0.15  # little room to drive: the arm has to do it
dt, margin = 1e-3, 0.02
post = tope.CollisionBody("post", tope.Cylinder(radius=0.05, length=1.0), position=[0.5, -0.2, 0.5])
keeping = tope.LimitOptions(collisions=tope.CollisionOptions(bodies=[post], margin=margin))


def drive(limits: tope.LimitOptions) -> tuple[np.ndarray, np.ndarray]:
    """Distances from post and robot itself, and from the goal, in each cycle of eight seconds."""
    behind, near = (tope.FramePosition(frame="ee", target=p) for p in ([0.3, -0.45, 0.2], [0.1, -0.1, 0.1]))
    controller = tope.Controller(robot, mode="velocity", dt=dt, limits=limits)
    observer = tope.Controller(robot, mode="velocity", dt=dt, limits=keeping)  # measures, commands nothing
    reach = controller.add(behind, level=1)
    q, u = np.array([0, 0, 0, 0, 0.4, 0.9, 0.6, 0]), np.zeros(robot.nv)
    distance, error = [], []
    for cycle in range(8000):
        if cycle == 4000:
            controller.replace(reach, near, over=0.5)
        observer.update(q, u, cycle * dt)
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        pairs = observer.distances  # by the names of sphere and body
        from_post = min(value for pair, value in pairs.items() if pair.endswith(".post"))
        from_itself = min(value for pair, value in pairs.items() if not pair.endswith(".post"))
        distance.append((from_post, from_itself))
        error.append(np.linalg.norm(controller.error(reach)))
    return np.array(distance), np.array(error)


(kept, error), (ignored, _) = drive(keeping), drive(tope.LimitOptions())
least, without = kept.min(axis=0), ignored.min(axis=0)
print(f"least distance from the post {1e3 * least[0]:.1f} mm, not told of it {1e3 * without[0]:.1f}")
print(f"least distance from itself {1e3 * least[1]:.1f} mm, not told of it {1e3 * without[1]:.1f}")
print(f"errors at the goals: {1e3 * error[3999]:.2f} mm, {1e3 * error[-1]:.2f} mm")
if __name__ == "__main__":
    reached = max(error[3999], error[-1]) < 1e-3
    sys.exit(0 if reached and least.min() > margin and without.max() < 0 else 1)
