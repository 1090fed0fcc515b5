"""Diamond turning machine with a rotary fast tool servo: spindle, cross slide, a motor with a flexible arm.

The machine is that of Ludwick, Chargin, Calzaretta and Trumper, "Calibration and Control of a Rotary Fast
Tool Servo" (MIT, 1999). The paper gives the arm length, the asymmetry, 500 Hz, 500 m/s^2 and 1.2 um at the
12th harmonic, but no inertia, resonance or force. Their defaults were chosen to agree with its numbers.

The angle of the arm is `phi = arm_zero + arm_angle`. The center of the tool nose is at the depth
`arm_length sin(phi)` into the part and at `center_offset - slide_position - arm_length cos(phi)` from the
spindle axis.
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import machining_native as _native
from machining_native import Cell
from plants.base.plant import Array, Channel, Plant
from plants.looks import rotary_arm as looks
from plants.rotary_arm_parameters import RotaryArmParameters

TURN = 2.0 * math.pi
RIPPLES = (5, 7, 18, 31)
"""Cycles of the ripple per revolution in addition to that of the paper: odd and even, the last above 24."""


class RotaryArm(Plant):
    """The machine. Channels: three encoders in, arm torque and the other axes out; see the tables below."""

    Parameters: ClassVar[type] = RotaryArmParameters
    wires: ClassVar[tuple[str, ...]] = (
        "torque", "enable", "speed_change", "slide_velocity", "cutting", "feed", "feed_ramp",
        "hum_angle", "hum_angle_next", "cutting_twice", "cutting_noise", "cutting_force",
        "probing", "probe_lateral", "probe_depth", "part_turned", "part_angle", "new_part",
        "chip_area", "chip_thrust", "arm_error", "arm_read", "spindle_error", "spindle_read",
    )  # fmt: skip

    def name_channels(self, p: RotaryArmParameters) -> None:
        """Name the channels, with noise, resolution and limits of the parameters."""
        limit = p.torque_limit
        self.readings = (
            Channel("arm_angle", "rad", "Arm encoder, from its index", quantum=p.arm_resolution),
            Channel("spindle_angle", "rad", "Spindle encoder, not wrapped", quantum=p.spindle_resolution),
            Channel("slide_position", "m", "Cross-slide encoder", quantum=p.slide_resolution),
            Channel("probe_depth", "m", "Probe, while it is down", p.probe_noise, p.probe_resolution),
            Channel(
                "probe_lateral", "m", "Position of the probe from the spindle axis", 0.0, p.slide_resolution
            ),
            Channel("part_angle", "rad", "Spindle angle at which the probe measures the part"),
        )
        self.commands = (
            Channel("torque", "N.m", "Torque command of the arm", 0.0, p.torque_resolution, -limit, limit),
            Channel(
                "enable", "1", "1 while the amplifier of the arm is on", minimum=0.0, maximum=1.0, start=1.0
            ),
            Channel("speed_change", "rad/s", "Spindle speed minus `spindle_speed`"),
            Channel("slide_velocity", "m/s", "Slide velocity in addition to the feed"),
            Channel("cutting", "1", "1 while the tool is in the part", minimum=0.0, maximum=1.0),
            Channel("probing", "1", "1 while the probe is down on the part", minimum=0.0, maximum=1.0),
            Channel("part_turned", "rad", "Angle to which the spindle is turned for the probe"),
            Channel("new_part", "1", "1 while a blank replaces the part", minimum=0.0, maximum=1.0),
        )
        self.truths = (
            Channel("tip_depth", "m", "Depth of the center of the tool nose from the arm axis"),
            Channel("tip_lateral", "m", "Distance of the center of the tool nose from the spindle axis"),
            Channel("tip_height", "m", "Height of the tool nose above the spindle axis"),
            Channel("arm_angle", "rad", "Angle of the hub from the encoder's index"),
            Channel("flexure", "rad", "Angle of the tool relative to the hub"),
            Channel("torque", "N.m", "Torque of the motor"),
            Channel("friction", "N.m", "Coulomb friction on the arm, last plant step"),
            Channel("ripple", "N.m", "Torque ripple on the arm, last plant step"),
            Channel("cutting_force", "N", "Thrust of the part on the tool, last plant step"),
            Channel("spindle_angle", "rad", "Angle of the spindle"),
            Channel("spindle_speed", "rad/s", "Speed of the spindle"),
            Channel("slide_position", "m", "Position of the slide"),
        )

    def shape(self, spec: Any, p: RotaryArmParameters) -> None:
        """Write lengths, inertias, stiffnesses, friction and drives into the MJCF."""
        spec.body("slide").pos[0] = p.center_offset
        spec.site("tool").pos[:2] = -p.arm_length, p.tool_height
        hub, arm = spec.body("hub"), spec.body("arm")
        hub.inertia[:], arm.inertia[:] = p.hub_inertia, p.arm_inertia
        spec.body("slide").mass = p.slide_mass - hub.mass - arm.mass
        spec.body("spindle").inertia[:] = p.spindle_inertia
        spec.joint("arm").damping[0] = p.viscous_friction
        spec.joint("arm").frictionloss = p.coulomb_friction
        flexure, speed = spec.joint("flexure"), TURN * p.flexure_frequency
        flexure.stiffness[0] = p.arm_inertia * speed**2
        flexure.damping[0] = 2.0 * p.flexure_damping * p.arm_inertia * speed
        self._shape_drives(spec)

    def _shape_drives(self, spec: Any) -> None:
        p = self.parameters
        torque, spindle, slide = (spec.actuator(name) for name in ("torque", "spindle", "slide"))
        torque.dynprm[0] = 1.0 / (TURN * p.current_bandwidth)
        torque.gainprm[0] = p.torque_gain
        torque.ctrllimited, torque.ctrlrange = True, [-p.torque_limit, p.torque_limit]
        spindle.gainprm[0], spindle.biasprm[2] = p.spindle_gain, -p.spindle_gain
        speed = TURN * p.slide_bandwidth
        stiffness, damping = p.slide_mass * speed**2, 2.0 * p.slide_damping * p.slide_mass * speed
        slide.gainprm[0] = stiffness
        slide.biasprm[1:3] = -stiffness, -damping

    def dress(self, spec: Any, p: RotaryArmParameters, shown: Mapping[str, Array]) -> None:
        """Clamp the part that the tool turns."""
        looks.dress(spec, p, shown)

    def begin(self, steps: int) -> None:
        """Sample angles and phases, start the spindle, bind the elements."""
        self._place()
        self._motor()
        self._spindle()
        self._slide()
        self._ripple()
        self._cutting(steps)
        self._part(steps)
        self._channels()

    def _place(self) -> None:
        p, data = self.parameters, self.data
        data.qpos[self._position("spindle")] = self.stream("spindle_angle").uniform(0.0, TURN)
        data.qpos[self._position("slide")] = p.slide_start
        data.qpos[self._position("arm")] = p.start_angle
        data.qvel[self._dof("spindle")] = p.spindle_speed

    def _motor(self) -> None:
        # without its amplifier the motor gives no torque: the arm coasts, its bearing has no brake
        wire = self.wire
        self.circuit.bind(
            "motor", _native.product(), [wire("enable"), wire("torque")], [self._control("torque")]
        )

    def _spindle(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        bind(
            "spindle_drive",
            _native.slew(p.spindle_speed, p.spindle_acceleration),
            [wire("speed_change", offset=p.spindle_speed)],
            [self._control("spindle")],
        )
        random = self.stream("spindle_ripple")
        for order, amplitude in ((1.0, p.spindle_ripple), (12.0, p.spindle_ripple_twelfth)):
            bind(
                f"spindle_ripple_{order:g}",
                _native.harmonics([(amplitude, random.uniform(0.0, TURN))]),
                [self._angle(scale=order)],
                [self._force("spindle")],
            )

    def _slide(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        feed = self._control("spindle", scale=p.feed / TURN)
        bind("feed", _native.summing_junction(2), [feed, wire("slide_velocity")], [wire("feed")])
        start = p.feed * p.spindle_speed / TURN
        bind("feed_ramp", _native.slew(start, p.slide_acceleration), [wire("feed")], [wire("feed_ramp")])
        bind("slide", _native.integrator(p.slide_start), [wire("feed_ramp")], [self._control("slide")])

    def _ripple(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        ripple, hum = self.stream("ripple").uniform(0.0, TURN, 2)
        bind(
            "ripple",
            _native.harmonics([(p.ripple_torque, ripple)]),
            [self._angle(scale=p.ripple_order)],
            [self._force("arm")],
        )
        if p.ripple_orders > 0.0:
            random = self.stream("ripple_orders")
            waves = [
                (p.ripple_orders if n in RIPPLES else 0.0, random.uniform(0.0, TURN)) for n in range(1, 32)
            ]
            bind("ripple_orders", _native.harmonics(waves), [self._angle()], [self._force("arm")])
        bind(
            "hum_angle",
            _native.rotation(hum),
            [self.constant(TURN * p.hum_frequency)],
            [wire("hum_angle"), wire("hum_angle_next")],
        )
        bind("hum", _native.harmonics([(p.hum_torque, 0.0)]), [wire("hum_angle")], [self._force("arm")])

    def _cutting(self, steps: int) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        # the thrust is largest where the part is highest: at the angle zero of a toric
        bind(
            "cutting_twice",
            _native.harmonics([(p.cutting_force_twice, TURN / 4.0)]),
            [self._angle(scale=2.0)],
            [wire("cutting_twice")],
        )
        bind(
            "cutting_noise",
            _native.coloured_noise(p.cutting_noise, 1.0 / (TURN * p.cutting_bandwidth)),
            [self.normals("cutting", steps)],
            [wire("cutting_noise")],
        )
        parts = [wire("cutting_twice", offset=p.cutting_force), wire("cutting_noise")]
        if p.cutting_pressure > 0.0:
            place = [self._angle(), *self._nose(), wire("cutting")]
            chip = _native.chip(p.tool_radius, p.depth_of_cut, p.part_radius, p.spindle_speed < 0.0)
            bind("chip", chip, place, [wire("chip_area")])
            parts.append(wire("chip_area", scale=p.cutting_pressure))
        bind("cutting_force", _native.summing_junction(len(parts)), parts, [wire("cutting_force")])
        bind(
            "thrust",
            _native.product(),
            [wire("cutting"), wire("cutting_force")],
            [self._control("thrust")],
        )

    def _part(self, steps: int) -> None:
        p, wire, data, bind = self.parameters, self.wire, self.data, self.circuit.bind
        place = Cell(data.qpos, self._position("slide"), scale=-1.0, offset=p.center_offset - p.probe_place)
        bind("probe_lateral", _native.summing_junction(1), [place], [wire("probe_lateral")])
        bind(
            "part",
            _native.turned_part(
                (p.tool_radius, p.roughness),
                p.probe_radius,
                (p.part_radius, p.part_face),
                round(p.part_diameters),
            ),
            [
                self._angle(),
                *self._nose(),
                wire("cutting"),
                self.normals("roughness", steps),
                wire("probing"),
                wire("probe_lateral"),
                wire("part_turned"),
                wire("new_part"),
            ],
            [wire("probe_depth"), wire("part_angle")],
        )

    def _channels(self) -> None:
        p, wire, data = self.parameters, self.wire, self.data
        arm, (lateral, depth) = self._dof("arm"), self._nose()
        angle = Cell(data.sensordata, 0, offset=-p.arm_zero)
        spindle, slide = Cell(data.sensordata, 1), Cell(data.sensordata, 2)
        torque = int(self.model.actuator_actadr[self.model.actuator("torque").id])
        away = self.stream("probe").uniform(-p.probe_misplacement, p.probe_misplacement)
        readings = {
            "arm_angle": self._grating("arm", angle, p.arm_eccentricity),
            "spindle_angle": self._grating("spindle", spindle, p.spindle_eccentricity),
            "slide_position": slide,
            "probe_depth": wire("probe_depth", offset=-p.probe_zero),
            "probe_lateral": wire("probe_lateral", offset=away),
            "part_angle": wire("part_angle"),
        }
        names = (
            "torque", "enable", "speed_change", "slide_velocity", "cutting", "probing", "part_turned",
            "new_part",
        )  # fmt: skip
        commands = {name: wire(name) for name in names}
        truths = {
            "tip_depth": depth,
            "tip_lateral": lateral,
            "tip_height": Cell(data.site_xpos, self._tool() + 1),
            "arm_angle": angle,
            "flexure": Cell(data.qpos, self._position("flexure")),
            "torque": Cell(data.act, torque, scale=p.torque_gain),
            "friction": Cell(data.qfrc_constraint, arm),
            "ripple": Cell(data.qfrc_applied, arm),
            "cutting_force": self._control("thrust"),
            "spindle_angle": spindle,
            "spindle_speed": Cell(data.qvel, self._dof("spindle")),
            "slide_position": slide,
        }
        self.connect(readings, commands, truths)

    def _grating(self, name: str, angle: Cell, eccentricity: float) -> Cell:
        # the grating is eccentric
        if eccentricity == 0.0:
            return angle
        phase = self.stream(f"{name}_eccentricity").uniform(0.0, TURN)
        error, read = self.wire(f"{name}_error"), self.wire(f"{name}_read")
        bind = self.sensing.bind
        bind(f"{name}_error", _native.harmonics([(eccentricity, phase)]), [angle], [error])
        bind(f"{name}_read", _native.summing_junction(2), [angle, error], [read])
        return read

    def _nose(self) -> tuple[Cell, Cell]:
        # lateral position and depth of its center
        tool = self._tool()
        return Cell(self.data.site_xpos, tool), Cell(self.data.site_xpos, tool + 2)

    def _angle(self, scale: float = 1.0) -> Cell:
        return Cell(self.data.qpos, self._position("spindle"), scale=scale)

    def _tool(self) -> int:
        return 3 * int(self.model.site("tool").id)

    def _position(self, joint: str) -> int:
        return int(self.model.joint(joint).qposadr[0])

    def _dof(self, joint: str) -> int:
        return int(self.model.joint(joint).dofadr[0])

    def _control(self, actuator: str, scale: float = 1.0) -> Cell:
        address = int(self.model.actuator_ctrladr[self.model.actuator(actuator).id])
        return Cell(self.data.ctrl, address, scale=scale)

    def _force(self, joint: str) -> Cell:
        return Cell(self.data.qfrc_applied, self._dof(joint), add=True)
