"""Deburring robot in cylindrical coordinates: six axes, an induction spindle, an edge with a burr.

The machine is that of Kimura, Mukai and Kobayashi, "A Variable-Speed Deburring Robot Using the Repetitive
Control". The paper gives the velocity loops, the spindle's plate and time constant, and the size of the burr,
but no mass, stiffness, geometry or cutting force. Those are defaults that reproduce its feed speeds.

Axis 1 rotates the column, axis 2 lifts the carriage, axis 3 moves the arm out: angle, height and radius of
the wrist. Axis 4 rotates the wrist about the vertical, axis 5 tilts it, axis 6 rotates the spindle about the
tool. With all three at zero the tool points down. The origin is on the axis of the column, at the height of
the wrist with axis 2 at zero.

The part may be displaced from its configured edge, and rotated about the vertical at its corner. Its wall is
above the edge. A touch probe, which replaces the tool while `probe` is 1, detects the wall.

Each drive has a spring-applied brake, as the axes of robots have: without `enable` the drives have no force
and the brakes are closed, with the largest force of the drive as dry friction (default). When it is enabled
again, a drive holds its present position.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import mujoco
import numpy as np

import machining_native as _native
from machining_native import Cell
from plants.base.plant import Array, Channel, Plant, vector
from plants.cylindrical_robot_parameters import TURN, CylindricalRobotParameters
from plants.looks import cylindrical_robot as looks
from plants.tools import burr

AXES = range(1, 7)
TURNING = (1, 4, 5, 6)
COUPLINGS = (1, 3)


class CylindricalRobot(Plant):
    """The machine. Channels: six encoders and the spindle speed in, six velocity commands out; see below.

    Raises
    ------
    ValueError
        The lines of the edge are too short for the radius of its corner.
    """

    Parameters: ClassVar[type] = CylindricalRobotParameters
    wires: ClassVar[tuple[str, ...]] = (
        "distance", "normal", "across", "tx", "ty", "tz", "nx", "ny", "nz", "workpiece",
        "load", "force", "feed", "engagement", "finish_low", "finish_high", "removed", "left",
        "spindle_speed", "spindle_measured", "spindle_torque", "enable",
        "probe", "contact", "deflection",
        *(f"hold_{n}" for n in AXES), *(f"{kind}_{n}" for kind in ("speed", "rubs") for n in (1, 3)),
    )  # fmt: skip

    def name_channels(self, p: CylindricalRobotParameters) -> None:
        """Name them, with the noise, resolution and limits of the parameters."""
        self._edge = edge(p)
        self._length = _native.edge_length(*self._edge)
        self.readings = (
            *(self._encoder(n) for n in AXES),
            Channel(
                "spindle_speed", "rad/s", "Speed of the tool, lagged", p.spindle_noise, p.spindle_resolution
            ),
            Channel("contact", "1", "1 while the touch probe touches the part"),
        )
        self.commands = (
            *(self._command(n) for n in AXES),
            Channel("workpiece", "1", "1 while the part is present", minimum=0.0, maximum=1.0),
            Channel(
                "enable", "1", "1 for enabled drives, 0 for closed brakes", 0.0, 0.0, 0.0, 1.0, start=1.0
            ),
            Channel("probe", "1", "1 while a touch probe is in place of the tool", minimum=0.0, maximum=1.0),
        )
        self.truths = (
            *vector("tip", "m", "Tip of the tool"),
            Channel("distance", "m", "Nearest position on the edge, from its start"),
            Channel("deviation", "m", "Tip from the edge: positive leaves burr, negative gouges"),
            Channel("deviation_across", "m", "Tip from the edge, across the plane of its corner"),
            Channel("feed", "m/s", "Speed along the edge, last plant step"),
            Channel("engagement", "m", "Depth of cut, last plant step"),
            Channel("cutting_torque", "N.m", "Load of the cut on the spindle, last plant step"),
            Channel("cutting_force", "N", "Tangential force of the cut, last plant step"),
            Channel("finish_low", "m", "Lowest position of the finished edge so far, negative is a gouge"),
            Channel("finish_high", "m", "Highest position of the finished edge so far"),
            Channel("burr_removed", "m3", "Volume that was cut"),
            Channel("burr_left", "m3", "Volume above the edge"),
            Channel("spindle_speed", "rad/s", "Speed of the tool"),
            Channel("spindle_torque", "N.m", "Torque of the spindle motor"),
            *(Channel(f"axis{n}_force", force_unit(n), f"Force of drive {n}, last plant step") for n in AXES),
            Channel("probe_deflection", "m", "Deflection of the touch probe, last plant step"),
        )

    def _encoder(self, axis: int) -> Channel:
        pulse = self._of(axis, "pulse")
        noise = self.parameters.encoder_noise * pulse
        return Channel(f"axis{axis}_position", unit(axis), f"Motor encoder of axis {axis}", noise, pulse)

    def _command(self, axis: int) -> Channel:
        most = self._of(axis, "speed")
        told = f"Velocity command of drive {axis}"
        return Channel(f"axis{axis}_velocity", f"{unit(axis)}/s", told, 0.0, 0.0, -most, most)

    def shape(self, spec: Any, p: CylindricalRobotParameters) -> None:
        """Write masses, rotors, couplings and drives into the MJCF."""
        spec.site("tip").pos[2] = -p.tool_length
        for n in AXES:
            joint, drive = spec.joint(f"axis_{n}"), spec.actuator(f"axis_{n}")
            joint.armature = self._of(n, "rotor")
            joint.frictionloss = p.coulomb_friction * self._of(n, "force")
            drive.forcelimited, drive.forcerange = True, [-self._of(n, "force"), self._of(n, "force")]
        spec.body("spindle").mass = p.tuned_payload
        inertia = self._inertias(spec)
        self._shape_drives(spec, inertia)
        self._shape_couplings(spec, inertia)
        spec.body("spindle").mass = p.payload

    def _inertias(self, spec: Any) -> dict[str, float]:
        """Inertia of each joint with all others held, at the reach for which the drives are tuned."""
        model = spec.compile()
        data = mujoco.MjData(model)
        data.joint("axis_3").qpos[0] = self.parameters.tuned_radius
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        return {model.joint(i).name: float(mass[i, i]) for i in range(model.njnt)}

    def _shape_drives(self, spec: Any, inertia: dict[str, float]) -> None:
        """Gains that meet the poles of G(s) in steps of the plant, not only in steps of no length."""
        p, h = self.parameters, self.parameters.timestep
        decay, oscillation = p.drive_damping * p.drive_frequency, 1.0 - p.drive_damping**2
        turned = h * p.drive_frequency * math.sqrt(abs(oscillation))
        angle = math.cos(turned) if oscillation > 0.0 else math.cosh(turned)
        # implicitfast: det z = 1 / (1 + a), trace z = 1 + (1 - b) / (1 + a)
        a = math.exp(2.0 * decay * h) - 1.0
        b = 1.0 - (2.0 * math.exp(-decay * h) * angle - 1.0) * (1.0 + a)
        for n in AXES:
            drive, mass = spec.actuator(f"axis_{n}"), inertia[f"axis_{n}"]
            drive.gainprm[0], drive.biasprm[1] = mass * b / h**2, -mass * b / h**2
            drive.biasprm[2] = -mass * a / h

    def _shape_couplings(self, spec: Any, inertia: dict[str, float]) -> None:
        p, speed = self.parameters, TURN * self.parameters.coupling_frequency
        for name in (f"coupling_{n}" for n in COUPLINGS):
            joint = spec.joint(name)
            if p.flexible:
                joint.stiffness[0] = inertia[name] * speed**2
                joint.damping[0] = 2.0 * p.coupling_damping * inertia[name] * speed
                if p.backlash > 0.0:
                    self._loosen(spec, name)
            else:
                spec.delete(joint)

    def _loosen(self, spec: Any, name: str) -> None:
        # a fixed tendon is a spring with a dead band
        p, joint = self.parameters, spec.joint(name)
        play = 0.5 * p.backlash / (p.tuned_radius if name == "coupling_1" else 1.0)
        tendon = spec.add_tendon(name=name, springlength=[-play, play])
        tendon.stiffness[0], joint.stiffness[0] = joint.stiffness[0], 0.0
        tendon.wrap_joint(name, 1.0)

    def dress(self, spec: Any, p: CylindricalRobotParameters, shown: Mapping[str, Array]) -> None:
        """Lay the casting with its burr."""
        looks.dress(spec, p, edge(p), _native.edge_length(*edge(p)))

    def draw(self, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]) -> None:
        """Take away the burr that was cut."""
        looks.draw(self, shown, row)

    def begin(self, steps: int) -> None:
        """Draw the burr, place the tip above the start of the edge, bind the elements."""
        p = self.parameters
        self._place()
        self._brake()
        if p.cogging > 0.0:
            self._cog()
        if p.reversal_friction > 0.0:
            self._rub()
        self._cut()
        self._touch()
        self._channels()

    def _place(self) -> None:
        p, data = self.parameters, self.data
        start = (
            math.atan2(p.edge_start_y, p.edge_start_x),
            p.edge_start_z + p.start_height + p.tool_length,
            math.hypot(p.edge_start_x, p.edge_start_y),
        )
        for n, place in zip(AXES, start, strict=False):
            data.joint(f"axis_{n}").qpos[0] = place
            # the drive holds where it is
            data.act[self.model.actuator(f"axis_{n}").actadr[0]] = place

    def _brake(self) -> None:
        """Without `enable` no force of the drives, closed brakes, and drives that hold where the axes are."""
        model, data, bind, product = self.model, self.data, self.circuit.bind, _native.product
        enable, disable = self.wire("enable"), self.wire("enable", scale=-1.0, offset=1.0)
        for n in AXES:
            drive, joint = model.actuator(f"axis_{n}"), model.joint(f"axis_{n}")
            force, friction = self._of(n, "force"), self.parameters.coulomb_friction * self._of(n, "force")
            for side, most in enumerate((-force, force)):
                limit = Cell(model.actuator_forcerange, 2 * int(drive.id) + side)
                bind(f"axis {n} limit {side}", product(), [enable, self.constant(most)], [limit])
            dof, place = int(joint.dofadr[0]), int(joint.qposadr[0])
            brake = Cell(model.dof_frictionloss, dof, offset=friction)
            bind(f"axis {n} brake", product(), [disable, self.constant(force)], [brake])
            model.dof_frictionloss[dof] = friction
            held, hold = Cell(data.act, int(drive.actadr[0])), f"hold_{n}"
            bind(f"axis {n} holds", product(), [enable, held], [self.wire(hold, add=True)])
            bind(f"axis {n} is", product(), [disable, Cell(data.qpos, place)], [self.wire(hold, add=True)])
            bind(f"axis {n} drive", product(), [self.constant(1.0), self.wire(hold)], [held])

    def _cog(self) -> None:
        p, random = self.parameters, self.stream("cogging")
        for n in AXES:
            period = p.axis1_cogging if n in TURNING else p.axis3_cogging
            wave = _native.harmonics([(p.cogging * self._of(n, "force"), random.uniform(0.0, TURN))])
            joint = self.model.joint(f"axis_{n}")
            place = Cell(self.data.qpos, int(joint.qposadr[0]), scale=TURN / period)
            force = Cell(self.data.qfrc_applied, int(joint.dofadr[0]), add=True)
            self.circuit.bind(f"cogging {n}", wave, [place], [force])

    def _rub(self) -> None:
        """Friction between load and frame: the encoder on the motor does not see what it does to the gear."""
        p, data, bind = self.parameters, self.data, self.circuit.bind
        for n in COUPLINGS:
            joints = (f"axis_{n}", f"coupling_{n}") if p.flexible else (f"axis_{n}",)
            moved = [int(self.model.joint(name).dofadr[0]) for name in joints]
            speed, rubs = self.wire(f"speed_{n}"), self.wire(f"rubs_{n}")
            load = [Cell(data.qvel, dof) for dof in moved]
            bind(f"speed {n}", _native.summing_junction(len(load)), load, [speed])
            law = _native.rolling_friction(p.reversal_friction * self._of(n, "force"), p.reversal_way)
            bind(f"reversal {n}", law, [speed], [rubs])
            for dof in moved:
                force = Cell(data.qfrc_applied, dof, add=True)
                bind(f"reversal {n} on {dof}", _native.summing_junction(1), [rubs], [force])

    def _cut(self) -> None:
        p, wire, data, bind = self.parameters, self.wire, self.data, self.circuit.bind
        tip = 3 * int(self.model.site("tip").id)
        place = [Cell(data.site_xpos, tip + i) for i in range(3)]
        seen = [wire(name) for name in self.wires[:9]]
        for circuit in (self.circuit, self.sensing):
            circuit.bind("edge", _native.edge(*self._edge), place, seen)
        length = max(self._length - p.burr_begin - p.burr_end, 0.0)
        self.burr = height, thickness = burr.draw(p, length, self.stream("burr"))
        mill = (p.teeth, p.tool_radius, p.cutting_pressure, p.edge_force, p.chip_most)
        reaction = (p.force_along, p.force_outward, p.tool_reach)
        bins = (p.burr_begin, p.burr_pitch)
        bind(
            "deburring",
            _native.deburring(bins, height.tolist(), thickness.tolist(), mill, reaction),
            [*seen, wire("spindle_speed"), wire("workpiece")],
            [wire("load"), wire("force"), *(self._control(f"force_{c}") for c in "xyz"),
             *(wire(name) for name in self.wires[12:18])],
        )  # fmt: skip
        plate = (p.synchronous_speed, p.rated_speed, p.rated_power, p.overload, p.spindle_time)
        bind(
            "spindle",
            _native.induction_spindle(plate, p.spindle_friction, p.spindle_lag),
            [wire("load")],
            [wire("spindle_speed"), wire("spindle_measured"), wire("spindle_torque")],
        )

    def _touch(self) -> None:
        p, wire = self.parameters, self.wire
        wall = (p.burr_begin, self._length - p.burr_end, p.wall_height)
        probe = (p.probe_pretravel, p.probe_travel, p.probe_stiffness, p.probe_end_stiffness)
        seen = [
            wire(name) for name in ("distance", "normal", "across", "nx", "ny", "nz", "workpiece", "probe")
        ]
        felt = [wire("contact"), wire("deflection")]
        force = [self._control(f"force_{c}", add=True) for c in "xyz"]
        self.circuit.bind("touch probe", _native.touch_probe(wall, probe), seen, [*felt, *force])

    def _channels(self) -> None:
        p, wire, data = self.parameters, self.wire, self.data
        tip = 3 * int(self.model.site("tip").id)
        readings = {f"axis{n}_position": Cell(data.sensordata, n - 1) for n in AXES}
        readings |= {"spindle_speed": wire("spindle_measured"), "contact": wire("contact")}
        commands = {f"axis{n}_velocity": self._control(f"axis_{n}", p.drive_gain) for n in AXES}
        commands |= {name: wire(name) for name in ("workpiece", "enable", "probe")}
        truths = {f"tip_{c}": Cell(data.site_xpos, tip + i) for i, c in enumerate("xyz")}
        named = {
            "distance": "distance", "deviation": "normal", "deviation_across": "across", "feed": "feed",
            "engagement": "engagement", "cutting_torque": "load", "cutting_force": "force",
            "finish_low": "finish_low", "finish_high": "finish_high", "burr_removed": "removed",
            "burr_left": "left", "spindle_speed": "spindle_speed", "spindle_torque": "spindle_torque",
            "probe_deflection": "deflection",
        }  # fmt: skip
        truths |= {truth: wire(name) for truth, name in named.items()}
        truths |= {f"axis{n}_force": Cell(data.actuator_force, n - 1) for n in AXES}
        self.connect(readings, commands, truths)

    def _of(self, axis: int, quantity: str) -> float:
        return float(getattr(self.parameters, f"axis{axis}_{quantity}"))

    def _control(self, actuator: str, scale: float = 1.0, *, add: bool = False) -> Cell:
        address = int(self.model.actuator_ctrladr[self.model.actuator(actuator).id])
        return Cell(self.data.ctrl, address, scale=scale, add=add)


def edge(p: CylindricalRobotParameters) -> tuple[list[float], list[float], list[float], float]:
    """Start, corner and end of the edge where the part lies, and the radius of its corner, m."""
    start, corner, end = (
        [float(getattr(p, f"edge_{point}_{c}")) for c in "xyz"] for point in ("start", "corner", "end")
    )
    start, corner, end = (displaced(p, point, corner) for point in (start, corner, end))
    return start, corner, end, p.edge_radius


def displaced(p: CylindricalRobotParameters, point: list[float], about: list[float]) -> list[float]:
    """Point of the part, moved and rotated about the vertical through a point."""
    x, y = point[0] - about[0], point[1] - about[1]
    # change by the rotation: exactly zero without one
    less, sine = math.cos(p.part_angle) - 1.0, math.sin(p.part_angle)
    return [point[0] + p.part_x + less * x - sine * y, point[1] + p.part_y + less * y + sine * x, point[2]]


def unit(axis: int) -> str:
    """SI unit of the position of an axis."""
    return "rad" if axis in TURNING else "m"


def force_unit(axis: int) -> str:
    """SI unit of the force of a drive."""
    return "N.m" if axis in TURNING else "N"
