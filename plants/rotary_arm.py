"""Diamond turning machine with a rotary fast tool servo: spindle, cross slide, a motor with a flexible arm.

The machine is that of Ludwick, Chargin, Calzaretta and Trumper, "Calibration and Control of a Rotary Fast
Tool Servo" (MIT, 1999). The paper gives the arm length, the asymmetry, 500 Hz, 500 m/s^2 and 1.2 um at the
12th harmonic, but no inertia, resonance or force. Those are our choice, such that the paper's numbers agree.

The angle of the arm is `phi = arm_zero + arm_angle`. The centre of the tool nose lies at the depth
`arm_length sin(phi)` into the part and at `centre_offset - slide_position - arm_length cos(phi)` from the
spindle axis.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from plants import _native
from plants._native import Cell
from plants.parameters import parameter
from plants.plant import Channel, Plant

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class RotaryArmParameters:
    """Parameters of the machine."""

    timestep: float = parameter(2e-5, "s", "Plant step", "derived: 31 nm rms at the tool", 1e-6, 1e-4)
    arm_length: float = parameter(0.08, "m", "Arm axis to the centre of the tool nose", "paper", 0.01, 0.5)
    arm_zero: float = parameter(
        0.0523, "rad", "Angle of the arm at the index of its encoder", "our choice: 3 degrees", -10.0, 10.0
    )
    centre_offset: float = parameter(
        0.15, "m", "Slide position with the arm axis on the spindle axis", "our choice", -1.0, 1.0
    )
    hub_inertia: float = parameter(
        4.5e-4, "kg.m2", "Motor, encoder and hub", "our choice: rotor 2e-4 and half an arm", 1e-6, 1.0
    )
    arm_inertia: float = parameter(
        3.5e-4, "kg.m2", "What bends: arm and both tool heads", "our choice: 20 g each at 80 mm", 1e-6, 1.0
    )
    flexure_frequency: float = parameter(
        1200.0, "Hz", "Resonance of the arm with the hub held", "our choice: above 500 Hz", 100.0, 1e4
    )
    flexure_damping: float = parameter(0.02, "1", "Damping ratio of that resonance", "our choice", 0.0, 0.5)
    viscous_friction: float = parameter(2e-3, "N.m.s/rad", "Of the arm bearing", "our choice", 0.0, 1.0)
    coulomb_friction: float = parameter(
        0.01, "N.m", "Of the arm bearing", "our choice: stays below the 12th harmonic", 0.0, 1.0
    )
    torque_limit: float = parameter(
        7.0, "N.m", "Largest torque", "derived: 500 m/s^2 at 8e-4 kg.m2 needs 5.0, 25 % more", 1e-3, 1e3
    )
    torque_gain: float = parameter(1.0, "1", "Torque per commanded torque", "our choice", 0.1, 10.0)
    torque_resolution: float = parameter(
        14.0 / 65_536.0, "N.m", "Step of the torque command", "our choice: 16 bit for +-7 N.m", 0.0, 1.0
    )
    current_bandwidth: float = parameter(2e3, "Hz", "Bandwidth of the current loop", "our choice", 10.0, 1e5)
    ripple_torque: float = parameter(
        6e-3, "N.m", "Arm torque in step with the spindle, amplitude", "our choice: gives the paper's 1.2 um",
        0.0, 1.0,
    )  # fmt: skip
    ripple_order: float = parameter(12.0, "1", "Its cycles per turn of the spindle", "paper", 0.0, 100.0)
    hum_torque: float = parameter(
        0.0, "N.m", "Arm torque of fixed frequency, amplitude", "our choice: none", 0.0, 1.0
    )
    hum_frequency: float = parameter(
        120.0, "Hz", "Its frequency", "our choice: twice the mains, the 12th of 600 rpm", 0.0, 5e3
    )
    cutting_force: float = parameter(2.0, "N", "Mean thrust on the tool", "our choice", 0.0, 1e3)
    cutting_force_twice: float = parameter(0.1, "N", "Thrust twice a turn, amplitude", "our choice", 0.0, 1e3)
    cutting_noise: float = parameter(0.03, "N", "Noise of the thrust, deviation", "our choice", 0.0, 1e2)
    cutting_bandwidth: float = parameter(800.0, "Hz", "Bandwidth of that noise", "our choice", 1.0, 1e5)
    spindle_speed: float = parameter(20.0 * math.pi, "rad/s", "At the start", "paper: 600 rpm", -1e3, 1e3)
    spindle_acceleration: float = parameter(
        10.0 * math.pi, "rad/s2", "Ramp of the drive", "our choice: 300 rpm in 1 s", 1e-3, 1e5
    )
    spindle_inertia: float = parameter(0.05, "kg.m2", "Spindle and part", "our choice", 1e-4, 1e3)
    spindle_gain: float = parameter(2.0, "N.m.s/rad", "Velocity loop of the drive", "our choice", 1e-3, 1e4)
    spindle_ripple: float = parameter(
        0.05, "N.m", "Drive torque once a turn, amplitude", "our choice: 0.02 % of the speed", 0.0, 1e2
    )
    spindle_ripple_twelfth: float = parameter(
        0.02, "N.m", "Drive torque twelve times a turn, amplitude", "our choice", 0.0, 1e2
    )
    slide_start: float = parameter(
        0.04, "m", "Slide position at the start", "paper: cutting radius 30 mm", -1.0, 1.0
    )
    feed: float = parameter(1e-5, "m", "Slide travel per turn of the spindle", "our choice", -1e-2, 1e-2)
    slide_acceleration: float = parameter(1.0, "m/s2", "Ramp of the slide drive", "our choice", 1e-3, 1e3)
    slide_mass: float = parameter(40.0, "kg", "All that the slide carries", "our choice", 2.0, 1e4)
    slide_bandwidth: float = parameter(
        30.0, "Hz", "Natural frequency of its position loop", "our choice", 1.0, 1e3
    )
    slide_damping: float = parameter(0.7, "1", "Damping ratio of that loop", "our choice", 0.01, 2.0)
    start_angle: float = parameter(
        0.0, "rad", "Angle of the arm at the start, 0 is along the slide", "our choice", -10.0, 10.0
    )
    tool_radius: float = parameter(
        2e-3, "m", "Radius of the tool nose", "our choice: usual diamond", 1e-5, 0.02
    )
    part_radius: float = parameter(0.05, "m", "Radius of the part", "paper: 100 mm", 1e-3, 0.5)
    part_face: float = parameter(-0.01, "m", "Depth of the face of the blank", "our choice", -1.0, 1.0)
    roughness: float = parameter(
        3e-8, "m", "What the material adds to a cut, deviation", "our choice", 0.0, 1e-3
    )
    probe_radius: float = parameter(1.5e-3, "m", "Radius of the probe ball", "our choice", 1e-5, 0.02)
    probe_place: float = parameter(
        0.08, "m", "Probe on the slide, from the arm axis to the spindle axis", "our choice", -1.0, 1.0
    )
    probe_misplacement: float = parameter(
        2e-5, "m", "Error of that place, drawn within +-", "our choice", 0.0, 1e-2
    )
    probe_zero: float = parameter(5e-3, "m", "Depth at which the probe reads 0", "our choice", -1.0, 1.0)
    probe_noise: float = parameter(5e-8, "m", "Probe noise, deviation", "our choice", 0.0, 1e-3)
    probe_resolution: float = parameter(1e-7, "m", "Step of the probe", "paper", 0.0, 1e-3)
    arm_resolution: float = parameter(
        TURN / 2**23, "rad", "Step of the arm encoder", "our choice: 60 nm at the tool", 0.0, 1e-2
    )
    spindle_resolution: float = parameter(
        TURN / 2**20, "rad", "Step of the spindle encoder", "our choice", 0.0, 1e-1
    )
    slide_resolution: float = parameter(1e-7, "m", "Step of the slide encoder", "our choice", 0.0, 1e-3)


class RotaryArm(Plant):
    """The machine. Channels: three encoders in, arm torque and the other axes out; see the tables below."""

    Parameters: ClassVar[type] = RotaryArmParameters
    wires: ClassVar[tuple[str, ...]] = (
        "speed_change", "slide_velocity", "cutting", "feed_velocity", "feed_ramp",
        "hum_angle", "hum_angle_next", "cutting_twice", "cutting_noise", "cutting_force",
        "probing", "probe_lateral", "probe_depth",
    )  # fmt: skip

    def __init__(self, parameters: RotaryArmParameters | None = None) -> None:
        super().__init__(parameters)
        p: RotaryArmParameters = self.parameters
        limit = p.torque_limit
        self.readings = (
            Channel("arm_angle", "rad", "Arm encoder, from its index", quantum=p.arm_resolution),
            Channel("spindle_angle", "rad", "Spindle encoder, not wrapped", quantum=p.spindle_resolution),
            Channel("slide_position", "m", "Cross-slide encoder", quantum=p.slide_resolution),
            Channel("probe_depth", "m", "Probe, while it is down", p.probe_noise, p.probe_resolution),
            Channel(
                "probe_lateral", "m", "Place of the probe from the spindle axis", 0.0, p.slide_resolution
            ),
        )
        self.commands = (
            Channel("torque", "N.m", "Torque command of the arm", 0.0, p.torque_resolution, -limit, limit),
            Channel("speed_change", "rad/s", "Spindle speed against `spindle_speed`"),
            Channel("slide_velocity", "m/s", "Slide velocity besides the feed"),
            Channel("cutting", "1", "1 while the tool is in the part", minimum=0.0, maximum=1.0),
            Channel("probing", "1", "1 while the probe is down on the part", minimum=0.0, maximum=1.0),
        )
        self.truths = (
            Channel("tip_depth", "m", "Depth of the centre of the tool nose from the arm axis"),
            Channel("tip_lateral", "m", "Distance of the centre of the tool nose from the spindle axis"),
            Channel("arm_angle", "rad", "Angle of the hub from the encoder's index"),
            Channel("flexure", "rad", "Angle of the tool against the hub"),
            Channel("torque", "N.m", "Torque of the motor"),
            Channel("friction", "N.m", "Coulomb friction on the arm, last plant step"),
            Channel("ripple", "N.m", "Torque ripple on the arm, last plant step"),
            Channel("cutting_force", "N", "Thrust of the part on the tool, last plant step"),
            Channel("spindle_angle", "rad", "Angle of the spindle"),
            Channel("spindle_speed", "rad/s", "Speed of the spindle"),
            Channel("slide_position", "m", "Position of the slide"),
        )

    def shape(self, spec: Any) -> None:
        """Write lengths, inertias, stiffnesses, friction and drives into the MJCF."""
        p = self.parameters
        spec.option.timestep = p.timestep
        spec.body("slide").pos[0] = p.centre_offset
        spec.site("tool").pos[0] = -p.arm_length
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

    def begin(self, steps: int) -> None:
        """Draw angles and phases, start the spindle, bind the elements."""
        self._place()
        self._axes()
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

    def _axes(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        random, spindle = self.stream("spindle_ripple"), self._position("spindle")
        drive = self._control("spindle")
        bind(
            "spindle_drive",
            _native.slew(p.spindle_speed, p.spindle_acceleration),
            [wire("speed_change", offset=p.spindle_speed)],
            [drive],
        )
        for order, amplitude in ((1.0, p.spindle_ripple), (12.0, p.spindle_ripple_twelfth)):
            bind(
                f"spindle_ripple_{order:g}",
                _native.harmonics([(amplitude, random.uniform(0.0, TURN))]),
                [Cell(self.data.qpos, spindle, scale=order)],
                [self._force("spindle")],
            )
        bind(
            "feed",
            _native.summing_junction(2),
            [self._control("spindle", scale=p.feed / TURN), wire("slide_velocity")],
            [wire("feed_velocity")],
        )
        start = p.feed * p.spindle_speed / TURN
        bind(
            "feed_ramp",
            _native.slew(start, p.slide_acceleration),
            [wire("feed_velocity")],
            [wire("feed_ramp")],
        )
        bind(
            "slide_drive",
            _native.integrator(p.slide_start),
            [wire("feed_ramp")],
            [self._control("slide")],
        )

    def _ripple(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        ripple, hum = self.stream("ripple").uniform(0.0, TURN, 2)
        bind(
            "ripple",
            _native.harmonics([(p.ripple_torque, ripple)]),
            [Cell(self.data.qpos, self._position("spindle"), scale=p.ripple_order)],
            [self._force("arm")],
        )
        bind(
            "hum_angle",
            _native.rotation(hum),
            [self.constant(TURN * p.hum_frequency)],
            [wire("hum_angle"), wire("hum_angle_next")],
        )
        bind("hum", _native.harmonics([(p.hum_torque, 0.0)]), [wire("hum_angle")], [self._force("arm")])

    def _cutting(self, steps: int) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        # the part resists most where it is highest: the angle zero of a toric
        bind(
            "cutting_twice",
            _native.harmonics([(p.cutting_force_twice, TURN / 4.0)]),
            [Cell(self.data.qpos, self._position("spindle"), scale=2.0)],
            [wire("cutting_twice")],
        )
        bind(
            "cutting_noise",
            _native.coloured_noise(p.cutting_noise, 1.0 / (TURN * p.cutting_bandwidth)),
            [self.normals("cutting", steps)],
            [wire("cutting_noise")],
        )
        bind(
            "cutting_force",
            _native.summing_junction(2),
            [wire("cutting_twice", offset=p.cutting_force), wire("cutting_noise")],
            [wire("cutting_force")],
        )
        bind(
            "thrust",
            _native.product(),
            [wire("cutting"), wire("cutting_force")],
            [self._control("thrust")],
        )

    def _part(self, steps: int) -> None:
        p, wire, data, bind = self.parameters, self.wire, self.data, self.circuit.bind
        tool = self._tool()
        place = Cell(data.qpos, self._position("slide"), scale=-1.0, offset=p.centre_offset - p.probe_place)
        bind("probe_lateral", _native.summing_junction(1), [place], [wire("probe_lateral")])
        bind(
            "part",
            _native.turned_part(p.tool_radius, p.probe_radius, p.part_radius, p.part_face, p.roughness),
            [
                Cell(data.qpos, self._position("spindle")),
                Cell(data.site_xpos, tool),
                Cell(data.site_xpos, tool + 2),
                wire("cutting"),
                self.normals("roughness", steps),
                wire("probing"),
                wire("probe_lateral"),
            ],
            [wire("probe_depth")],
        )

    def _channels(self) -> None:
        p, wire, data = self.parameters, self.wire, self.data
        arm, tool = self._dof("arm"), self._tool()
        angle = Cell(data.sensordata, 0, offset=-p.arm_zero)
        spindle, slide = Cell(data.sensordata, 1), Cell(data.sensordata, 2)
        torque = int(self.model.actuator_actadr[self.model.actuator("torque").id])
        away = self.stream("probe").uniform(-p.probe_misplacement, p.probe_misplacement)
        readings = {
            "arm_angle": angle,
            "spindle_angle": spindle,
            "slide_position": slide,
            "probe_depth": wire("probe_depth", offset=-p.probe_zero),
            "probe_lateral": wire("probe_lateral", offset=away),
        }
        commands = {name: wire(name) for name in ("speed_change", "slide_velocity", "cutting", "probing")}
        truths = {
            "tip_depth": Cell(data.site_xpos, tool + 2),
            "tip_lateral": Cell(data.site_xpos, tool),
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
        self.connect(readings, {"torque": self._control("torque"), **commands}, truths)

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
