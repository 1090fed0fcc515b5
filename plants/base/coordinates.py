"""Names and units of the numbers in MuJoCo's `qpos`."""

from collections.abc import Iterator
from typing import Any

import mujoco

SLIDE, FREE = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_FREE


def coordinates(model: Any) -> Iterator[tuple[str, str]]:
    """Name and unit of every number of `qpos`, in its order.

    A joint has `qpos.<joint>`, or `qpos.<joint>[i]` for several numbers; those of a joint without
    name are `qpos[i]`.
    """
    for number, start in enumerate(model.jnt_qposadr.tolist()):
        joint, kind = model.joint(number), model.jnt_type[number]
        count = len(joint.qpos0)
        for i in range(count):
            place = f"[{i}]" if count > 1 else ""
            length = kind == SLIDE or (kind == FREE and i < 3)
            angle = count == 1 and not length
            name = f"qpos.{joint.name}{place}" if joint.name else f"qpos[{start + i}]"
            yield name, "m" if length else ("rad" if angle else "1")
