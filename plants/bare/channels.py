"""Channels of a bare MJCF: sensors, actuators and joints by name, with the units known from MuJoCo."""

from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from typing import Any, NamedTuple

import mujoco

from plants.base.plant import Channel, PlantError

KINDS = {"slide": ("m", "m/s", "N"), "hinge": ("rad", "rad/s", "N.m"), "": ("", "", "")}
"""Units of position, velocity and force along a joint, tendon or actuator, if known."""
SENSOR_UNITS = {
    "TOUCH": "N", "ACCELEROMETER": "m/s2", "VELOCIMETER": "m/s", "GYRO": "rad/s", "FORCE": "N",
    "TORQUE": "N.m", "MAGNETOMETER": "T", "RANGEFINDER": "m", "BALLQUAT": "1", "BALLANGVEL": "rad/s",
    "FRAMEPOS": "m",
    "FRAMEQUAT": "1", "FRAMEXAXIS": "1", "FRAMEYAXIS": "1", "FRAMEZAXIS": "1", "FRAMELINVEL": "m/s",
    "FRAMEANGVEL": "rad/s", "FRAMELINACC": "m/s2", "FRAMEANGACC": "rad/s2", "SUBTREECOM": "m",
    "SUBTREELINVEL": "m/s", "SUBTREEANGMOM": "N.m.s", "INSIDESITE": "1", "GEOMDIST": "m", "GEOMNORMAL": "1",
    "GEOMFROMTO": "m", "E_POTENTIAL": "J", "E_KINETIC": "J", "CLOCK": "s",
}  # fmt: skip
"""Units of the sensor types with a fixed unit, by MuJoCo's name of the type."""
ALONG = {"JOINT": "joint", "TENDON": "tendon", "ACTUATOR": "actuator"}
"""Sensors of a joint, tendon or actuator, such as `JOINTPOS`, with the unit of that element."""
QUANTITIES = {"POS": 0, "VEL": 1, "FRC": 2}
INPUTS = {
    "pos": "Position setpoint", "vel": "Velocity setpoint", "ff": "Feedforward force", "voltage": "Voltage",
    "pressure": "Pressure", **dict.fromkeys(("rx", "ry", "rz"), "Rotation vector, setpoint"),
    **dict.fromkeys(("qw", "qx", "qy", "qz"), "Quaternion, setpoint"),
}  # fmt: skip
"""Descriptions of the inputs of actuators, by MuJoCo's names."""
VECTOR, QUATERNION = "xyz", "wxyz"
SERVOS = (("FIXED", "AFFINE"), ("SO3", "SO3"))
"""Kinds of gain and bias of actuators that are a servo if their numbers match."""
PID = ("PID", "AFFINE")


class BoundChannel(NamedTuple):
    """A channel and the location of its value: `getattr(data, array)[place]`."""

    channel: Channel
    array: str
    place: int


def readings(model: Any) -> tuple[BoundChannel, ...]:
    """One measurement for each component of each named sensor; its noise is the `noise` of the MJCF."""
    return unique(one for i in range(model.nsensor) for one in sensor(model, i))


def commands(model: Any, data: Any) -> tuple[BoundChannel, ...]:
    """One command for each control of each named actuator; its limits are the `ctrlrange` of the MJCF.

    Its start value is the `ctrl` of `data`, which a keyframe may have set.
    """
    return unique(one for i in range(model.nactuator) for one in actuator(model, data, i))


def truths(model: Any, data: Any) -> tuple[BoundChannel, ...]:
    """Positions and velocities of the named joints, commands and forces of the actuators, all sensors.

    A sensor replaces the signal of a joint or actuator with the same name.
    """
    sensed = [
        one._replace(channel=Channel(one.channel.name, one.channel.unit, one.channel.description))
        for one in readings(model)
    ]
    names = {one.channel.name for one in sensed}

    def derived() -> Iterator[BoundChannel]:
        for i in range(model.njnt):
            yield from joint(model, i)
        for one in commands(model, data):
            name, label = one.channel.name, "Command that acts in this step"
            yield BoundChannel(Channel(f"{name}.command", one.channel.unit, label), one.array, one.place)
        for i in range(model.nactuator):
            yield from force(model, i)

    return unique(chain((one for one in derived() if one.channel.name not in names), sensed))


def unique(bound: Iterable[BoundChannel]) -> tuple[BoundChannel, ...]:
    """Return all channels, which must have different names."""
    found: dict[str, BoundChannel] = {}
    for one in bound:
        if one.channel.name in found:
            raise PlantError(
                f"two channels of the MJCF are called `{one.channel.name}`\n"
                "hint: Rename one of the sensors, joints or actuators."
            )
        found[one.channel.name] = one
    return tuple(found.values())


def sensor(model: Any, i: int) -> Iterator[BoundChannel]:
    """Components of a sensor; those of accelerations and forces are known only at the end of a plant step."""
    name, type_name = (
        model.sensor(i).name,
        mujoco.mjtSensor(model.sensor_type[i]).name.removeprefix("mjSENS_"),
    )
    late = model.sensor_needstage[i] == mujoco.mjtStage.mjSTAGE_ACC
    label = f"Sensor `{type_name.lower()}`" + (", of the plant step before" if late else "")
    quaternion = model.sensor_datatype[i] == mujoco.mjtDataType.mjDATATYPE_QUATERNION
    unit, noise = sensor_unit(model, i, type_name), float(model.sensor_noise[i])
    for index, part in enumerate(components(name, int(model.sensor_dim[i]), quaternion)):
        channel = Channel(part, unit, label, noise=noise)
        yield BoundChannel(channel, "sensordata", int(model.sensor_adr[i]) + index)


def actuator(model: Any, data: Any, i: int) -> Iterator[BoundChannel]:
    """List the controls of an actuator; a passive one has none, several have MuJoCo's names of its inputs."""
    name, count = model.actuator(i).name, int(model.actuator_ctrlnum[i])
    for k in range(count if name else 0):
        row, of = int(model.actuator_ctrladr[i]) + k, mujoco.mj_actuatorInputName(model, i, k) or ""
        low, high = model.actuator_ctrlrange[row].tolist()
        limits = {"minimum": low, "maximum": high} if model.actuator_ctrllimited[row] else {}
        channel = Channel(
            name if count == 1 else f"{name}.{of or k + 1}",
            command_unit(model, i, of),
            f"{INPUTS.get(of, 'Control')} of `{name}`",
            start=float(data.ctrl[row]),
            **limits,
        )
        yield BoundChannel(channel, "ctrl", row)


def force(model: Any, i: int) -> Iterator[BoundChannel]:
    """Force of an actuator with a single output."""
    name = model.actuator(i).name
    if name and model.actuator_outnum[i] == 1:
        unit = KINDS[actuator_kind(model, i)][2]
        channel = Channel(f"{name}.force", unit, f"Force of `{name}`, of the plant step before")
        yield BoundChannel(channel, "actuator_force", int(model.actuator_outadr[i]))


def joint(model: Any, i: int) -> Iterator[BoundChannel]:
    """Position and velocity of a joint; a free or ball joint has vectors and a quaternion.

    As in MuJoCo the velocity of a free joint is in world axes, its angular velocity in body axes.
    """
    name, kind = model.joint(i).name, model.jnt_type[i]
    if not name:
        return
    q, v = int(model.jnt_qposadr[i]), int(model.jnt_dofadr[i])
    position, velocity, _ = KINDS[joint_kind(model, i)]
    parts: list[tuple[str, str, str, int]]
    if joint_kind(model, i):
        parts = [(f"{name}.position", position, "qpos", q), (f"{name}.velocity", velocity, "qvel", v)]
    else:
        parts = []
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            parts += [(f"{name}.position.{axis}", "m", "qpos", q + k) for k, axis in enumerate(VECTOR)]
            parts += [(f"{name}.velocity.{axis}", "m/s", "qvel", v + k) for k, axis in enumerate(VECTOR)]
            q, v = q + 3, v + 3
        parts += [(f"{name}.rotation.{axis}", "1", "qpos", q + k) for k, axis in enumerate(QUATERNION)]
        parts += [
            (f"{name}.angular_velocity.{axis}", "rad/s", "qvel", v + k) for k, axis in enumerate(VECTOR)
        ]
    for part, unit, array, index in parts:
        yield BoundChannel(Channel(part, unit, f"Joint `{name}`"), array, index)


def components(name: str, count: int, quaternion: bool = False) -> list[str]:
    """Names of components: `v`, `v.x v.y v.z`, `q.w q.x q.y q.z`, or `v[1] ...`; none without name."""
    if not name:
        return []
    if count == 1:
        return [name]
    if quaternion or count == len(VECTOR):
        return [f"{name}.{axis}" for axis in (QUATERNION if quaternion else VECTOR)]
    return [f"{name}[{k}]" for k in range(1, count + 1)]


def sensor_unit(model: Any, i: int, type_name: str) -> str:
    """Return the unit of a sensor; empty if unknown."""
    kinds: dict[str, Callable[[Any, int], str]] = {
        "joint": joint_kind, "tendon": tendon_kind, "actuator": actuator_kind,
    }  # fmt: skip
    for start, thing in ALONG.items():
        if type_name.startswith(start):
            return KINDS[kinds[thing](model, int(model.sensor_objid[i]))][QUANTITIES[type_name[-3:]]]
    return SENSOR_UNITS.get(type_name, "")


def joint_kind(model: Any, i: int) -> str:
    """Kind of a joint: slide, hinge, or none for free and ball joints."""
    kinds = {mujoco.mjtJoint.mjJNT_SLIDE: "slide", mujoco.mjtJoint.mjJNT_HINGE: "hinge"}
    return kinds.get(mujoco.mjtJoint(model.jnt_type[i]), "")


def tendon_kind(model: Any, i: int) -> str:
    """Kind of a tendon: a slide for a spatial tendon, otherwise that of its joints if they are equal."""
    first, count = int(model.tendon_adr[i]), int(model.tendon_num[i])
    if model.wrap_type[first] != mujoco.mjtWrap.mjWRAP_JOINT:
        return "slide"
    kinds = {joint_kind(model, int(model.wrap_objid[k])) for k in range(first, first + count)}
    return kinds.pop() if len(kinds) == 1 else ""


def actuator_kind(model: Any, i: int) -> str:
    """Kind of the element that an actuator drives directly; a gear can have any unit."""
    gear, target = model.actuator_gear[i], int(model.actuator_trnid[i, 0])
    if abs(gear[0]) != 1.0 or gear[1:].any():
        return ""
    transmission = mujoco.mjtTrn(model.actuator_trntype[i])
    if transmission in (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT):
        return joint_kind(model, target)
    if transmission == mujoco.mjtTrn.mjTRN_TENDON:
        return tendon_kind(model, target)
    return "slide" if transmission == mujoco.mjtTrn.mjTRN_SLIDERCRANK else ""


def command_unit(model: Any, i: int, of: str) -> str:
    """Return the unit of an input: named in the MJCF, force of a motor, setpoint of a servo, or unknown."""
    position, velocity, effort = KINDS[actuator_kind(model, i)]
    units = {"pos": position, "vel": velocity, "ff": effort, "voltage": "V", "pressure": "Pa"}
    if of:
        return units.get(of, "rad" if of[0] == "r" else "1")
    if model.actuator_gaintype[i] != mujoco.mjtGain.mjGAIN_FIXED:
        return ""
    if model.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_NONE:
        return effort if model.actuator_gainprm[i, 0] == 1.0 else ""
    integrates = model.actuator_dyntype[i] == mujoco.mjtDyn.mjDYN_INTEGRATOR
    setpoints = {"position": velocity if integrates else position, "velocity": velocity, "": ""}
    return setpoints[servo(model, i)]


def gain_and_bias(model: Any, i: int) -> tuple[str, str]:
    """Kinds of the gain and of the bias of an actuator, by MuJoCo's names."""
    gain, bias = mujoco.mjtGain(model.actuator_gaintype[i]), mujoco.mjtBias(model.actuator_biastype[i])
    return gain.name.removeprefix("mjGAIN_"), bias.name.removeprefix("mjBIAS_")


def servo(model: Any, i: int) -> str:
    """Return the setpoint kind of an actuator: `position`, `velocity`, or empty."""
    gain, bias = float(model.actuator_gainprm[i, 0]), model.actuator_biasprm[i]
    kinds = gain_and_bias(model, i)
    if kinds not in (*SERVOS, PID):
        return ""
    if gain == -bias[1] or kinds == PID:
        return "position"
    return "velocity" if gain == -bias[2] and bias[1] == 0.0 else ""
