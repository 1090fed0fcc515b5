"""Air-bearing slide with a linear motor that carries a rotating micro end mill towards a workpiece.

The machine is that of Kakinuma and Nagakari, "Sensor-less micro-tool contact detection for ultra-precision
machine tools utilizing the disturbance observer technique", CIRP Annals 66 (2017). The paper gives its kind,
the 16 bit current and the nanometer scale; the other numbers are typical of such machines.
Position is positive towards the workpiece.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import mujoco

import machining_native as _native
from machining_native import Cell
from plants.base.plant import Array, Channel, Plant
from plants.looks import slide as looks
from plants.slide_parameters import SlideParameters, check_together

TURN = 2.0 * math.pi
NOWHERE = 1.0
"""Position of the surface when there is no workpiece, m: beyond the travel."""


class Slide(Plant):
    """The slide. Channels: encoder and spindle speed in, motor current out; see the tables below."""

    Parameters: ClassVar[type] = SlideParameters
    wires: ClassVar[tuple[str, ...]] = (
        "command", "enable", "amplifier_noise", "loop_current", "current", "angle", "angle_next",
        "spindle_force", "disturbance", "position_peak", "touched",
        "wobble_angle", "wobble_angle_next", "wobble", "speed", "floor_angle", "floor_angle_next",
        "interpolation", "encoder", "chip_force", "floor", "tool",
    )  # fmt: skip

    def name_channels(self, p: SlideParameters) -> None:
        """Name them, with noise, resolution and limits of the parameters."""
        limit = p.current_limit
        self.readings = (
            Channel("position", "m", "Encoder", noise=p.encoder_noise, quantum=p.encoder_resolution),
            Channel("spindle_speed", "rad/s", "Speed of the spindle drive"),
        )
        self.commands = (
            Channel("current", "A", "Current command", 0.0, p.current_resolution, -limit, limit),
            Channel("enable", "1", "Power stage of the drive: 0 blocks the current immediately", start=1.0),
        )
        self.truths = (
            Channel("position", "m", "Position of the slide"),
            Channel("velocity", "m/s", "Velocity of the slide"),
            Channel("surface", "m", "Position at which the longest flute can first touch"),
            Channel("depth", "m", "Travel of the tool beyond the first possible touch, negative before"),
            Channel("depth_max", "m", "Largest depth up to the last plant step"),
            Channel("contact_force", "N", "Force of the workpiece on the tool, sum of the flutes"),
            Channel("touched", "1", "1 from the first contact force on"),
            Channel("indentation", "m", "Permanent indentation of the surface, or maximum depth of the cut"),
            Channel("disturbance", "N", "Force on the slide without the contact, last plant step"),
            Channel("current", "A", "Motor current, mean of the last plant step"),
        )
        self._z = int(self.model.joint("z").qposadr[0])
        # joints that a force on the tool moves
        self._tool = [int(self.model.joint(name).qposadr[0]) for name in ("z", "tool")[: 1 + _bends(p)]]
        self._flutes = [self.model.tendon(name).id for name in ("flute1", "flute2")]

    def shape(self, spec: Any, p: SlideParameters) -> None:
        """Write masses, damping, stiffnesses and yield depth into the MJCF."""
        check_together(p)
        spec.body("slide").mass = p.mass
        self._shape_tool(spec)
        spec.joint("z").damping[0] = p.damping
        for tendon in (spec.tendon("flute1"), spec.tendon("flute2")):
            # a flute that cuts has its spring in the element of the chip
            tendon.stiffness[0] = 0.0 if p.cutting_pressure > 0.0 else p.stiffness
            tendon.springyield = p.yield_depth

    def _shape_tool(self, spec: Any) -> None:
        # spindle and tool on a spring that the encoder does not measure
        p = self.parameters
        if not _bends(p):
            return
        speed, slide = TURN * p.tool_frequency, spec.body("slide")
        slide.mass = p.mass - p.tool_mass
        tool = slide.add_body(name="tool", mass=p.tool_mass, inertia=[0.01, 0.01, 0.01])
        joint = tool.add_joint(name="tool", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, -1.0])
        joint.stiffness[0] = p.tool_mass * speed**2
        joint.damping[0] = 2.0 * p.tool_damping * p.tool_mass * speed
        for name in ("flute1", "flute2"):
            spec.tendon(name).wrap_joint("tool", 1.0)

    def draw(self, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]) -> None:
        """Put the workpiece where the displayed tool meets it."""
        looks.draw(self, shown, row, enlarged)

    def begin(self, steps: int) -> None:
        """Sample positions and phases, put the workpiece, bind the elements."""
        self._place()
        self._cogging()
        self._motor(steps)
        self._spindle()
        self._place_tool()
        self._cut()
        self._disturbances(steps)
        self._observers()

    def _place(self) -> None:
        p, random = self.parameters, self.stream("places")
        start = random.uniform(-p.start_spread, p.start_spread)
        distance = p.surface_distance + random.uniform(0.0, p.surface_spread)
        self.surface = start + distance if p.workpiece else NOWHERE
        self.model.tendon_lengthspring[self._flutes, 1] = self.surface
        # reset again: a yielding spring keeps its own copy of the surface
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._z] = start

    def _cogging(self) -> None:
        # passive MuJoCo elements: amplitude sin(wavenumber position + phase)
        p, random = self.parameters, self.stream("cogging")
        wavenumber = TURN / p.magnetic_pitch
        for name, amplitude, order in (("cogging1", p.cogging, 1), ("cogging2", p.cogging_half, 2)):
            phase = random.uniform(0.0, TURN)
            row = self.model.actuator(name).id
            self.model.actuator_biasprm[row, :3] = amplitude, order * wavenumber, phase

    def _motor(self, steps: int) -> None:
        p, wire = self.parameters, self.wire
        bandwidth = TURN * p.current_bandwidth
        phase = self.stream("force_ripple").uniform(0.0, TURN)
        thrust = Cell(self.data.ctrl, self.model.actuator_ctrladr[self.model.actuator("thrust").id])
        bind = self.circuit.bind
        bind(
            "amplifier_noise",
            _native.coloured_noise(p.amplifier_noise, 1.0 / bandwidth),
            [self.normals("amplifier", steps)],
            [wire("amplifier_noise")],
        )
        bind(
            "current_loop",
            _native.current_loop(bandwidth),
            [wire("command"), wire("amplifier_noise")],
            [wire("loop_current")],
        )
        bind("power", _native.product(), [wire("loop_current"), wire("enable")], [wire("current")])
        bind(
            "thrust",
            _native.thrust(p.force_constant, p.force_ripple, p.magnetic_pitch, phase),
            [wire("current"), Cell(self.data.qpos, self._z)],
            [thrust],
        )

    def _spindle(self) -> None:
        p, wire, random = self.parameters, self.wire, self.stream("spindle")
        angle, first, second = random.uniform(0.0, TURN, 3)
        bind = self.circuit.bind
        self.speed = self._wobbling() if p.spindle_wobble > 0.0 else self.constant(p.spindle_speed)
        bind("spindle", _native.rotation(angle), [self.speed], [wire("angle"), wire("angle_next")])
        bind(
            "spindle_force",
            _native.harmonics([(p.spindle_force, first), (p.spindle_force_twice, second)]),
            [wire("angle")],
            [wire("spindle_force")],
        )
        self._on_tool("spindle_force")
        # mj_step2 only moves the slide, so the flutes are placed for the end of the step
        flutes = (("retreat1", 0.0, 0.0), ("retreat2", p.flute_shortfall, math.pi))
        for joint, shortfall, offset in flutes:
            place = Cell(self.data.qpos, int(self.model.joint(joint).qposadr[0]))
            bind(joint, _native.flute(shortfall, p.tilt, offset), [wire("angle_next")], [place])

    def _wobbling(self) -> Cell:
        p, wire = self.parameters, self.wire
        self._wave("wobble", p.wobble_frequency, p.spindle_wobble * p.spindle_speed, wire("wobble"))
        swing = [wire("wobble", offset=p.spindle_speed)]
        self.circuit.bind("speed", _native.summing_junction(1), swing, [wire("speed")])
        return wire("speed")

    def _wave(self, name: str, frequency: float, amplitude: float, output: Cell) -> None:
        # a sine over the time, its phase drawn
        angles = [self.wire(f"{name}_angle"), self.wire(f"{name}_angle_next")]
        phase = self.stream(name).uniform(0.0, TURN)
        self.circuit.bind(f"{name}_angle", _native.rotation(phase), [self.constant(TURN * frequency)], angles)
        self.circuit.bind(name, _native.harmonics([(amplitude, 0.0)]), angles[:1], [output])

    def _place_tool(self) -> None:
        # the structural mode is between encoder and tool
        if _bends(self.parameters):
            parts = [Cell(self.data.qpos, place) for place in self._tool]
            for circuit in (self.circuit, self.sensing):
                circuit.bind("tool", _native.summing_junction(2), parts, [self.wire("tool")])

    def _tip(self, offset: float = 0.0) -> Cell:
        if _bends(self.parameters):
            return self.wire("tool", offset=offset)
        return Cell(self.data.qpos, self._z, offset=offset)

    def _cut(self) -> None:
        p, wire, data = self.parameters, self.wire, self.data
        if p.cutting_pressure > 0.0:
            retreats = [Cell(data.qpos, int(self.model.joint(f"retreat{n}").qposadr[0])) for n in (1, 2)]
            inputs = [self._tip(-self.surface), *retreats, wire("angle"), wire("angle_next")]
            plunge = _native.plunge(p.stiffness, p.cutting_pressure * p.cutting_width)
            self.circuit.bind("chip", plunge, inputs, [wire("chip_force"), wire("floor")])
            self._on_tool("chip_force", -1.0)

    def _disturbances(self, steps: int) -> None:
        p, residual = self.parameters, self.parameters.balancer_residual
        weight = self.stream("balancer_residual").uniform(-residual, residual)
        bind = self.circuit.bind
        bind(
            "balancer",
            _native.coloured_noise(p.balancer_sway, p.balancer_time),
            [self.normals("balancer_sway", steps)],
            [self._force(offset=weight)],
        )
        bind(
            "air",
            _native.coloured_noise(p.air_noise, 1.0 / (TURN * p.air_bandwidth)),
            [self.normals("air", steps)],
            [self._force()],
        )
        if p.floor_force > 0.0:
            self._wave("floor", p.floor_frequency, p.floor_force, self._force())

    def _observers(self) -> None:
        wire, data, z = self.wire, self.data, self._z
        cuts = self.parameters.cutting_pressure > 0.0
        contact = wire("chip_force") if cuts else Cell(data.qfrc_spring, z, scale=-1.0)
        actuators = [self.model.actuator(name).id for name in ("cogging1", "cogging2")]
        cogging = [Cell(data.actuator_force, actuator, scale=-1.0) for actuator in actuators]
        friction = Cell(data.qvel, z, scale=self.parameters.damping)
        applied = Cell(data.qfrc_applied, z, scale=-1.0)
        bind = self.circuit.bind
        bind("position_peak", _native.peak(), [self._tip()], [wire("position_peak")])
        bind("touched", _native.latch(), [contact], [wire("touched")])
        holding = [applied, *cogging, friction]
        if cuts:
            holding.append(wire("chip_force", scale=-1.0))
        bind("disturbance", _native.summing_junction(len(holding)), holding, [wire("disturbance")])
        truths = {
            "position": Cell(data.qpos, z),
            "velocity": Cell(data.qvel, z),
            "surface": self.constant(self.surface),
            "depth": self._tip(-self.surface),
            "depth_max": wire("position_peak", offset=-self.surface),
            "contact_force": contact,
            "touched": wire("touched"),
            "indentation": self._indentation(),
            "disturbance": wire("disturbance"),
            "current": wire("current"),
        }
        readings = {"position": self._encoder(), "spindle_speed": self.speed}
        self.connect(readings, {"current": wire("command"), "enable": wire("enable")}, truths)

    def _encoder(self) -> Cell:
        p, wire, true = self.parameters, self.wire, Cell(self.data.sensordata, 0)
        if p.encoder_interpolation == 0.0:
            return true
        error = _native.harmonics([(p.encoder_interpolation, self.stream("encoder").uniform(0.0, TURN))])
        signal = Cell(self.data.sensordata, 0, scale=TURN / p.encoder_period)
        self.sensing.bind("interpolation", error, [signal], [wire("interpolation")])
        parts = [true, wire("interpolation")]
        self.sensing.bind("encoder", _native.summing_junction(2), parts, [wire("encoder")])
        return wire("encoder")

    def _indentation(self) -> Cell:
        if self.parameters.cutting_pressure > 0.0:
            return self.wire("floor")
        # the longest flute goes deepest
        row = int(self.model.tendon_plasticadr[self._flutes[0]])
        return self.constant(0.0) if row < 0 else Cell(self.data.plastic, row + 1, offset=-self.surface)

    def _on_tool(self, name: str, sign: float = 1.0) -> None:
        for place in self._tool:
            applied = Cell(self.data.qfrc_applied, place, add=True)
            force = [self.wire(name, scale=sign)]
            self.circuit.bind(f"{name}_{place}", _native.summing_junction(1), force, [applied])

    def _force(self, offset: float = 0.0) -> Cell:
        return Cell(self.data.qfrc_applied, self._z, offset=offset, add=True)


def _bends(p: SlideParameters) -> bool:
    return p.tool_frequency > 0.0
