"""Parameters of a bare MJCF: numbers of its named elements that a study can vary."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import Field, field, fields, make_dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from plants.bare.channels import KINDS, PID, actuator_kind, gain_and_bias, joint_kind, servo, tendon_kind
from plants.base.parameters import choice

COEFFICIENTS = {
    "slide": {
        "damping": "N.s/m", "stiffness": "N/m", "armature": "kg", "frictionloss": "N", "integral": "N/(m.s)",
    },
    "hinge": {
        "damping": "N.m.s/rad", "stiffness": "N.m/rad", "armature": "kg.m2", "frictionloss": "N.m",
        "integral": "N.m/(rad.s)",
    },
    "": dict.fromkeys(("damping", "stiffness", "armature", "frictionloss", "integral"), ""),
}  # fmt: skip
"""Units of the coefficients of a joint, tendon or servo."""
Place = tuple[str, Any, float]
"""Array of the model, index, and factor of the parameter."""
Term = tuple[str, tuple[Place, ...], str, str, float]
"""A number of an actuator: last part of its key, locations, unit, description and minimum."""
SOURCE = "the MJCF"
RATIO = "dampratio"
TINY = float(mujoco.mjMINVAL)
INTEGRATORS = {
    name.removeprefix("mjINT_").lower(): kind
    for name, kind in mujoco.mjtIntegrator.__members__.items()
    if kind != mujoco.mjtIntegrator.mjINT_RK4
}
"""MuJoCo's integrators by their names in lower case; without RK4, which cannot be split at the sensors."""


def parameters_of(model: Any, spec: Any) -> type:
    """Dataclass of the parameters of a model compiled from `spec`; the defaults are those of the MJCF.

    The key of a field, such as `joint.slide.damping`, is in its metadata, with the location of its number.
    """
    entries = [
        *options(model),
        *bodies(model),
        *joints(model, spec),
        *tendons(model),
        *geoms(model),
        *actuators(model, damping_ratios(model, spec)),
    ]
    named = [(f"p{k}", kind, entry) for k, (kind, entry) in enumerate(entries)]
    return make_dataclass("BareParameters", named, frozen=True)


def entry(
    key: str,
    default: float | None,
    unit: str,
    description: str,
    minimum: float = -math.inf,
    places: tuple[Place, ...] = (),
) -> tuple[Any, Any]:
    """Type and field of one parameter, which is written to all its locations."""
    metadata = {
        "key": key, "unit": unit, "description": description, "source": SOURCE, "minimum": minimum,
        "maximum": math.inf, "places": places,
    }  # fmt: skip
    kind: Any = float | None if default is None else float
    return kind, field(default=default, metadata=metadata)


def one_of(key: str, default: str, description: str, names: tuple[str, ...]) -> tuple[Any, Any]:
    """Type and field of a parameter with a list of names; the default may be another one."""
    text = f"{description}, one of `{'`, `'.join(names)}`"
    item: Any = choice(default, text, names, SOURCE)
    kind: Any = Literal.__getitem__(names)
    return kind, field(default=default, metadata={**item.metadata, "key": key, "places": ()})


def options(model: Any) -> Iterator[tuple[Any, Any]]:
    """Step, integrator, gravity and, if there are any, the initial keyframe."""
    yield entry("timestep", float(model.opt.timestep), "s", "Plant step", 1e-9)
    integrator = next((name for name, kind in INTEGRATORS.items() if kind == model.opt.integrator), "rk4")
    yield one_of("integrator", integrator, "Integrator", tuple(INTEGRATORS))
    for k, axis in enumerate("xyz"):
        yield entry(f"gravity.{axis}", float(model.opt.gravity[k]), "m/s2", "Gravity")
    if names := tuple(model.key(k).name for k in range(model.nkey) if model.key(k).name):
        yield one_of("keyframe", "", "Start: a keyframe", names)


def bodies(model: Any) -> Iterator[tuple[Any, Any]]:
    """Masses of the named bodies with mass."""
    for i in range(1, model.nbody):
        name, mass = model.body(i).name, float(model.body_mass[i])
        if name and mass > 0.0:
            text = "Mass; the inertia follows in proportion"
            yield entry(f"body.{name}.mass", mass, "kg", text, TINY, at("body_mass", i))


def joints(model: Any, spec: Any) -> Iterator[tuple[Any, Any]]:
    """Coefficients of the named joints, and the start of slides and hinges."""
    for i in range(model.njnt):
        name, kind = model.joint(i).name, joint_kind(model, i)
        if not name:
            continue
        first = int(model.jnt_dofadr[i])
        dofs = slice(first, int(np.count_nonzero(model.dof_jntid == i)) + first)
        places = {"damping": dofs, "armature": dofs, "frictionloss": dofs, "stiffness": i}
        for what, index in places.items():
            array = f"{'jnt' if what == 'stiffness' else 'dof'}_{what}"
            value = float(np.ravel(getattr(model, array)[index])[0])
            text = f"{what.capitalize()} of the joint"
            if what in ("damping", "stiffness") and any(spec.joint(name).springdamper):
                text += ", from `springdamper` and the masses of the file"
            yield entry(f"joint.{name}.{what}", value, COEFFICIENTS[kind][what], text, 0.0, at(array, index))
        if kind:
            unit = "m" if kind == "slide" else "rad"
            text = f"Start position; default: of the keyframe, or {model.qpos0[model.jnt_qposadr[i]]:g}"
            yield entry(f"joint.{name}.position", None, unit, text)
            yield entry(
                f"joint.{name}.velocity", None, f"{unit}/s", "Start velocity; default: of the keyframe, or 0"
            )


def tendons(model: Any) -> Iterator[tuple[Any, Any]]:
    """Coefficients of the named tendons."""
    for i in range(model.ntendon):
        name, units = model.tendon(i).name, COEFFICIENTS[tendon_kind(model, i)]
        for what in ("damping", "stiffness", "armature", "frictionloss") if name else ():
            array = f"tendon_{what}"
            value, text = float(getattr(model, array)[i]), f"{what.capitalize()} of the tendon"
            yield entry(f"tendon.{name}.{what}", value, units[what], text, 0.0, at(array, i))


def geoms(model: Any) -> Iterator[tuple[Any, Any]]:
    """Sliding friction of the named geoms."""
    for i in range(model.ngeom):
        if name := model.geom(i).name:
            value, places = float(model.geom_friction[i, 0]), at("geom_friction", (i, 0))
            yield entry(f"geom.{name}.friction", value, "1", "Sliding friction coefficient", 0.0, places)


def actuators(model: Any, ratios: Mapping[int, float]) -> Iterator[tuple[Any, Any]]:
    """Gears, gains and biases of the named actuators; a servo has `kp`, and `kv` or `dampratio`."""
    for i in range(model.nactuator):
        name, unit = model.actuator(i).name, KINDS[actuator_kind(model, i)][2]
        if not name:
            continue
        terms = [("gear", at("actuator_gear", (i, 0)), "", "First number of the gear", -math.inf)]
        terms += servo_terms(model, i, i in ratios) if servo(model, i) else affine_terms(model, i)
        if model.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_AFFINE:
            text = "Force without control, `biasprm[0]`"
            terms.append(("bias", at("actuator_biasprm", (i, 0)), unit, text, -math.inf))
        for key, places, unit, text, minimum in terms:
            array, index, factor = places[0]
            # the sum makes a zero of a negative zero
            value = 0.0 + factor * float(getattr(model, array)[index])
            yield entry(f"actuator.{name}.{key}", value, unit, text, minimum, places)
        if i in ratios:
            places = at("actuator_biasprm", (i, 2))
            text = "Damping ratio; the damping follows `kp` and the masses"
            yield entry(f"actuator.{name}.{RATIO}", ratios[i], "1", text, TINY, places)


def servo_terms(model: Any, i: int, by_ratio: bool) -> list[Term]:
    """Gains of a servo: MuJoCo keeps each in the gain and, negative, in the bias."""
    units = COEFFICIENTS[actuator_kind(model, i)]
    gain, velocity = at("actuator_gainprm", (i, 0)), at("actuator_biasprm", (i, 2), -1.0)
    if servo(model, i) == "velocity":
        return [("kv", gain + velocity, units["damping"], "Gain of the velocity", 0.0)]
    position = at("actuator_biasprm", (i, 1), -1.0)
    pid = gain_and_bias(model, i) == PID
    places = position if pid else gain + position
    terms: list[Term] = [("kp", places, units["stiffness"], "Gain of the position", 0.0)]
    if not by_ratio:
        terms.append(("kv", velocity, units["damping"], "Damping of the servo", 0.0))
    # a gain of zero has no state for the integral
    if pid and model.actuator_gainprm[i, 0] > 0.0:
        terms.append(("ki", gain, units["integral"], "Gain of the integral of the position error", TINY))
    return terms


def damping_ratios(model: Any, spec: Any) -> dict[int, float]:
    """Damping ratios of the actuators that have one, by index; `model` is compiled from `spec`."""
    # the compiler replaces the positive ratio by a negative damping
    given = {one.id: float(one.biasprm[2]) for one in spec.actuators}
    return {i: ratio for i, ratio in given.items() if ratio > 0.0 > model.actuator_biasprm[i, 2]}


def damp(model: Any, data: Any, ratios: Mapping[int, float]) -> None:
    """Set the damping of servos with a damping ratio, as MuJoCo's compiler does."""
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    for i, ratio in ratios.items():
        outputs = int(model.actuator_outadr[i]) + np.arange(model.actuator_outnum[i])
        moment = np.zeros((len(outputs), model.nv))
        for row, k in zip(moment, outputs, strict=True):
            first = int(data.moment_rowadr[k])
            of = slice(first, first + int(data.moment_rownnz[k]))
            row[data.moment_colind[of]] = data.actuator_moment[of]
        solved = np.zeros_like(moment)
        mujoco.mj_solveM(model, data, solved, moment)
        mass = 1.0 / np.mean(np.sum(moment * solved, axis=1))
        model.actuator_biasprm[i, 2] = -2.0 * ratio * math.sqrt(-model.actuator_biasprm[i, 1] * mass)


def affine_terms(model: Any, i: int) -> list[Term]:
    """Gain over control, and the slopes of an affine gain and bias."""
    units, terms = COEFFICIENTS[actuator_kind(model, i)], []
    affine = model.actuator_gaintype[i] == mujoco.mjtGain.mjGAIN_AFFINE
    if affine or model.actuator_gaintype[i] == mujoco.mjtGain.mjGAIN_FIXED:
        text = "Force over control, `gainprm[0]`"
        terms.append(("gain", at("actuator_gainprm", (i, 0)), "", text, -math.inf))
    slopes = [("length", units["stiffness"]), ("velocity", units["damping"])]
    for k, (what, unit) in enumerate(slopes, 1):
        if affine:
            text = f"Gain over {what}, `gainprm[{k}]`"
            terms.append((f"gain_{what}", at("actuator_gainprm", (i, k)), "", text, -math.inf))
        if model.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_AFFINE:
            text = f"Bias over {what}, `biasprm[{k}]`"
            terms.append((f"bias_{what}", at("actuator_biasprm", (i, k)), unit, text, -math.inf))
    return terms


def at(array: str, index: Any, factor: float = 1.0) -> tuple[Place, ...]:
    """Return one location."""
    return ((array, index, factor),)


def apply(parameters: Any, model: Any, data: Any, ratios: Mapping[int, float]) -> None:
    """Write the changed parameters into the model; `ratios` are the damping ratios of the MJCF."""
    placed = [item for item in fields(parameters) if item.metadata["places"]]
    changed = [item for item in placed if getattr(parameters, item.name) != item.default]
    for item in changed:
        put(item, getattr(parameters, item.name), model)
    values = named(parameters)
    model.opt.timestep = values["timestep"]
    model.opt.gravity[:] = [values[f"gravity.{axis}"] for axis in "xyz"]
    if changed:
        # what MuJoCo derives from masses and lengths when it compiles
        mujoco.mj_setConst(model, data)
        ratios = {i: values.get(f"actuator.{model.actuator(i).name}.{RATIO}", ratios[i]) for i in ratios}
        if ratios:
            damp(model, data, ratios)


def put(item: Field[Any], value: float, model: Any) -> None:
    """Write one number to its locations."""
    for array, index, factor in item.metadata["places"]:
        if array == "body_mass":
            model.body_inertia[index] *= value / model.body_mass[index]
        getattr(model, array)[index] = factor * value


def start(parameters: Any, model: Any, data: Any) -> None:
    """Set the initial state: keyframe first, then the given joints."""
    values = named(parameters)
    if keyframe := values.get("keyframe"):
        mujoco.mj_resetDataKeyframe(model, data, model.key(keyframe).id)
    for i in range(model.njnt):
        name = model.joint(i).name
        for quantity, array, index in (
            ("position", data.qpos, model.jnt_qposadr[i]),
            ("velocity", data.qvel, model.jnt_dofadr[i]),
        ):
            if (value := values.get(f"joint.{name}.{quantity}")) is not None:
                array[index] = value


def named(parameters: Any) -> dict[str, Any]:
    """Values by key."""
    return {item.metadata["key"]: getattr(parameters, item.name) for item in fields(parameters)}
