"""Ring on the table of a vertical spindle, probed and pushed to the centre by a slide.

The machine is that of Mears, Roth, Djurdjanovic, Yang and Kurfess, "Design of a flexible centering tooling
system" (2007). The paper gives resolutions, gauging force, slide speed and the range of friction; masses,
radii, stiffness and servo are typical of such machines and our choice.

The x axis is the line of the slide, through the spindle; probe and pusher come from +x. Slide position is
positive towards the centre, probe position positive when it collapses, the spindle angle positive about +z.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import mujoco
import numpy as np
from numpy.typing import NDArray

from plants import _native
from plants._native import Cell, Circuit
from plants.parameters import ParameterError, parameter
from plants.plant import Channel, Plant

TURN = 2.0 * math.pi
SAMPLES = 8192
"""Samples of the outline of the ring over one turn."""
ROUGHNESS_ORDERS = range(15, 101)
"""Waves per turn of the roughness."""
ERROR_ORDERS = range(2, 6)
"""Cycles per turn of the error motion: one cycle per turn is eccentricity by definition."""
TOUCH = 1e-6
"""Collapse at which the preload of the probe is there, m."""
LINE_LIMIT = 0.95
"""Most that the centre of the ring may be beside the line of the probe, in radii."""
NOWHERE = -1.0
"""Surface when there is no ring, m: beyond the travel."""
RING = ("ring_x", "ring_y", "ring_yaw")
FEET = ("foot1", "foot2", "foot3")


@dataclass(frozen=True)
class SpindleRingParameters:
    """Parameters of spindle, ring and slide."""

    timestep: float = parameter(1e-4, "s", "Plant step", "our choice", 1e-6, 2e-4)
    spindle_speed: float = parameter(
        TURN / 3.0, "rad/s", "Spindle speed, positive about +z", "paper: 20 rpm", -20.0, 20.0
    )
    spindle_error: float = parameter(
        0.0,
        "m",
        "Error motion of the axis in x and in y, amplitudes of n = 2 to 5 in all",
        "our choice",
        0.0,
        1e-4,
    )
    spindle_error_noise: float = parameter(
        0.0, "m", "Asynchronous error motion in x and in y, deviation", "our choice", 0.0, 1e-4
    )
    spindle_error_time: float = parameter(
        0.05, "s", "Correlation time of the asynchronous part", "our choice", 1e-3, 1e3
    )
    table_radius: float = parameter(0.15, "m", "Radius of the table", "our choice", 0.01, 1.0)

    part_present: bool = parameter(True, "1", "Whether there is a ring", "our choice")
    mass: float = parameter(1.0, "kg", "Mass of the ring", "paper: 0.75 to 1.5 kg", 0.1, 200.0)
    radius: float = parameter(0.05, "m", "Mean outer radius of the ring", "our choice", 0.01, 0.5)
    wall: float = parameter(0.15, "1", "Thickness of the ring over its radius", "our choice", 0.01, 1.0)
    feet_radius: float = parameter(
        0.04, "m", "Radius of the three points on which the ring rests", "our choice", 1e-3, 0.5
    )
    eccentricity: float = parameter(
        5e-4, "m", "Distance of the ring from the axis at first", "our choice", 0.0, 0.1
    )
    eccentricity_angle: float = parameter(
        0.0, "rad", "Direction in which the ring is off at first, on the table", "our choice", -TURN, TURN
    )
    eccentricity_angle_spread: float = parameter(
        math.pi, "rad", "Added to that, drawn within +-", "our choice: any direction", 0.0, math.pi
    )
    lobe_2: float = parameter(2e-6, "m", "Two lobes (oval), amplitude, phase drawn", "our choice", 0.0, 1e-3)
    lobe_3: float = parameter(2e-6, "m", "Three lobes, amplitude, phase drawn", "our choice", 0.0, 1e-3)
    lobe_5: float = parameter(5e-7, "m", "Five lobes, amplitude, phase drawn", "our choice", 0.0, 1e-3)
    roughness: float = parameter(
        1e-7, "m", "Roughness of 15 to 100 waves per turn, deviation, phases drawn", "our choice", 0.0, 1e-4
    )

    mu_static: float = parameter(
        0.2, "1", "Static friction of ring on table", "paper: 0.15 to 0.25", 0.01, 2.0
    )
    mu_ratio: float = parameter(1.25, "1", "Static over kinetic friction", "our choice", 1.0, 5.0)
    stribeck_speed: float = parameter(
        1e-3, "m/s", "Slip speed of the Stribeck curve", "our choice", 1e-5, 1.0
    )
    bristle: bool = parameter(False, "1", "Elasto-plastic bristle instead of MuJoCo's contacts", "our choice")
    presliding: float = parameter(
        1e-6, "m", "Bristle: deflection at the static force", "our choice", 1e-7, 1e-4
    )
    break_away: float = parameter(
        0.7, "1", "Bristle: purely elastic share of that deflection", "our choice", 0.1, 0.99
    )
    bristle_damping: float = parameter(
        0.2, "1", "Bristle: damping ratio of the ring on it", "our choice", 0.0, 1.0
    )

    pusher_stiffness: float = parameter(5e6, "N/m", "Stiffness of the pusher tip", "our choice", 1e4, 1e8)
    pusher_damping: float = parameter(
        0.15, "1", "Damping ratio of the ring on the tip", "our choice", 0.0, 1.0
    )
    pusher_friction: float = parameter(0.12, "1", "Friction of pusher on ring", "our choice", 0.0, 1.0)
    probe_at_pusher: float = parameter(
        0.02, "m", "Probe position with the surface at the pusher tip", "our choice", 0.0, 0.1
    )
    probe_stroke: float = parameter(0.025, "m", "Stroke of the probe", "our choice", 1e-3, 0.1)
    probe_force_free: float = parameter(0.35, "N", "Gauging force at first touch", "our choice", 0.0, 10.0)
    probe_force_full: float = parameter(0.7, "N", "Gauging force at full stroke", "paper", 0.0, 10.0)
    probe_friction: float = parameter(
        0.1, "1", "Friction of probe on ring", "our choice: ruby on steel", 0.0, 1.0
    )
    probe_resolution: float = parameter(50e-9, "m", "Resolution of the probe", "paper", 0.0, 1e-4)
    probe_noise: float = parameter(30e-9, "m", "Noise of the probe, deviation", "paper", 0.0, 1e-4)

    dirt_height: float = parameter(
        0.0, "m", "Height of the particles that stick to the ring", "our choice", 0.0, 1e-3
    )
    dirt_fraction: float = parameter(
        0.02, "1", "Share of the circumference under particles", "our choice", 0.0, 0.5
    )
    dirt_width: float = parameter(
        5e-4,
        "m",
        "Width of a particle under the probe tip",
        "our choice: 20 um under a ball of 3 mm",
        1e-4,
        0.01,
    )
    spike_height: float = parameter(
        0.0, "m", "Electrical spikes on the probe, up or down", "our choice", 0.0, 1e-3
    )
    spike_fraction: float = parameter(0.02, "1", "Share of the readings that are hit", "our choice", 0.0, 0.5)

    slide_mass: float = parameter(8.0, "kg", "Moving mass of the slide", "our choice", 0.5, 200.0)
    servo_bandwidth: float = parameter(
        40.0, "Hz", "Natural frequency of the slide's servo", "our choice", 1.0, 500.0
    )
    servo_damping: float = parameter(0.7, "1", "Damping ratio of the slide's servo", "our choice", 0.05, 5.0)
    servo_force: float = parameter(400.0, "N", "Largest force of the slide's motor", "our choice", 1.0, 1e5)
    setpoint_period: float = parameter(
        1e-3, "s", "Longest time for which the servo extrapolates a setpoint", "our choice: 1 kHz", 0.0, 1.0
    )
    slide_velocity_max: float = parameter(
        0.12, "m/s", "Largest velocity setpoint of the slide", "paper", 1e-3, 10.0
    )
    slide_resolution: float = parameter(20e-9, "m", "Resolution of the slide's encoder", "paper", 0.0, 1e-4)
    travel: float = parameter(0.15, "m", "Travel of the slide from its start", "our choice", 0.01, 1.0)
    start_distance: float = parameter(
        0.03,
        "m",
        "From the free probe to the place of a centred surface at the start",
        "our choice",
        0.0,
        0.5,
    )
    angle_resolution: float = parameter(
        TURN / 4000.0, "rad", "Resolution of the spindle's encoder", "paper: 0.09 deg", 0.0, 0.1
    )


class SpindleRing(Plant):
    """Spindle, ring and slide. Channels: three encoders in, two setpoints out; see the tables below."""

    Parameters: ClassVar[type] = SpindleRingParameters
    wires: ClassVar[tuple[str, ...]] = (
        "position_setpoint", "velocity_setpoint",
        "async_x", "async_y", "sync_x", "sync_y", "error_x", "error_y",
        "cx", "cy", "vcx", "vcy", "orientation", "turn_rate", "eccentricity", "slip_speed",
        "surface", "normal_x", "normal_y", "vx", "vy", "phase", "dirt", "probed", "fx", "fy",
        "probe_collapse", "probe_force", "probe_reading", "pusher_compression", "pusher_force", "pusher_gap",
    )  # fmt: skip

    def __init__(self, parameters: SpindleRingParameters | None = None) -> None:
        super().__init__(parameters)
        p: SpindleRingParameters = self.parameters
        _check_together(p)
        self.readings = (
            Channel("spindle_angle", "rad", "Encoder of the spindle, unwrapped", quantum=p.angle_resolution),
            Channel("slide_position", "m", "Encoder of the slide", quantum=p.slide_resolution),
            Channel(
                "probe_position",
                "m",
                "Encoder of the probe",
                p.probe_noise,
                p.probe_resolution,
                0.0,
                p.probe_stroke,
            ),
        )
        speed = p.slide_velocity_max
        self.commands = (
            Channel(
                "slide_position_setpoint", "m", "Where the slide should be", minimum=0.0, maximum=p.travel
            ),
            Channel("slide_velocity_setpoint", "m/s", "How fast it should go", minimum=-speed, maximum=speed),
        )
        self.truths = (
            Channel("ring_x", "m", "Centre of the ring on the table"),
            Channel("ring_y", "m", "Centre of the ring on the table"),
            Channel("ring_yaw", "rad", "Angle of the ring on the table"),
            Channel("eccentricity", "m", "Distance of the ring from the axis"),
            Channel("slip_speed", "m/s", "Speed of the ring's centre on the table"),
            Channel("spindle_angle", "rad", "Angle of the spindle"),
            Channel("slide_position", "m", "Position of the slide"),
            Channel("slide_velocity", "m/s", "Velocity of the slide"),
            Channel("surface", "m", "Place of the ring's surface on the line of the probe, from the axis"),
            Channel("probe_force", "N", "Force of the probe on the ring"),
            Channel("pusher_force", "N", "Force of the pusher on the ring"),
            Channel("pusher_gap", "m", "From the pusher tip to the surface, negative when it is compressed"),
        )
        # the pusher tip is here when the slide is at zero
        self.pusher_start: float = p.radius + p.start_distance + p.probe_at_pusher
        self._at = {name: int(self.model.joint(name).qposadr[0]) for name in ("spindle", "slide", *RING)}
        self._weight = -p.mass * float(self.model.opt.gravity[2])
        self._load_feet()

    def shape(self, spec: Any) -> None:
        """Write masses and sizes into the MJCF; the bristle takes the place of the contacts."""
        p = self.parameters
        spec.option.timestep = p.timestep
        spec.geom("plate").size[0] = p.table_radius
        spec.geom("outline").size[0] = p.radius
        spec.body("ring").mass = p.mass
        inertia = 0.5 * p.mass * p.radius**2 * (1.0 + (1.0 - p.wall) ** 2)
        spec.body("ring").inertia = 0.5 * inertia, 0.5 * inertia, inertia
        spec.body("slide").mass = p.slide_mass
        spec.body("slide").pos[0] = p.radius + p.start_distance + p.probe_at_pusher
        for foot, (x, y) in zip(FEET, _feet(p), strict=True):
            spec.geom(foot).pos[:2] = x, y
        if p.bristle:
            for pair in list(spec.pairs):
                spec.delete(pair)
        for pair in spec.pairs:
            # slip is gone after one step: the largest stiffness that does not overshoot
            pair.solreffriction[0] = 2.0 * p.timestep / pair.solimp[1]

    def _load_feet(self) -> None:
        # the load of a foot is proportional to its margin
        mujoco.mj_forward(self.model, self.data)
        force = np.zeros(6)
        for foot in range(self.model.npair):
            mujoco.mj_contactForce(self.model, self.data, foot, force)
            self.model.pair_margin[foot] *= self._weight / len(FEET) / force[0]

    def begin(self, steps: int) -> None:
        """Place the ring, draw outline, dirt and errors, bind the elements."""
        p = self.parameters
        self._place()
        self._contours = _outline(p, self.stream("outline")), _dirt(p, self.stream("dirt"))
        random = self.stream("spindle_error")
        self._error_phases = {axis: random.uniform(0.0, TURN, len(ERROR_ORDERS)) for axis in "xy"}
        if p.spindle_error_noise > 0.0:
            self._asynchronous(steps)
        for circuit in (self.sensing, self.circuit):
            self._touch(circuit)
        if p.spike_height > 0.0:
            self._spikes(steps)
        self._servo()
        if p.part_present:
            self._friction()
            self._push()
        self._channels()

    def _place(self) -> None:
        p, data, at = self.parameters, self.data, self._at
        spread = p.eccentricity_angle_spread
        angle = p.eccentricity_angle + self.stream("eccentricity").uniform(-spread, spread)
        distance = p.eccentricity if p.part_present else 0.0
        data.qpos[at["ring_x"]] = distance * math.cos(angle)
        data.qpos[at["ring_y"]] = distance * math.sin(angle)
        data.qvel[at["spindle"]] = data.ctrl[0] = p.spindle_speed
        self.model.pair_friction[:, :2] = p.mu_static
        self.wire("surface").write(NOWHERE)
        self.wire("normal_x").write(1.0)

    # elements

    def _asynchronous(self, steps: int) -> None:
        p = self.parameters
        for axis in "xy":
            noise = _native.coloured_noise(p.spindle_error_noise, p.spindle_error_time)
            source = self.normals(f"spindle_error_{axis}", steps)
            self.circuit.bind(f"spindle_error_{axis}", noise, [source], [self.wire(f"async_{axis}")])

    def _touch(self, circuit: Circuit) -> None:
        # where the ring is and what probe and pusher do to it: in every step, and when readings are taken
        p, wire = self.parameters, self.wire
        if p.part_present:
            self._ring(circuit)
        seen = ["normal_x", "normal_y", "vx", "vy"]
        damping = 2.0 * p.pusher_damping * math.sqrt(p.pusher_stiffness * p.mass)
        rate = (p.probe_force_full - p.probe_force_free) / p.probe_stroke
        tips = {
            "probe": _native.tip(p.probe_force_free, TOUCH, rate, 0.0, p.probe_friction),
            "pusher": _native.tip(0.0, TOUCH, p.pusher_stiffness, damping, p.pusher_friction),
        }
        pusher = Cell(self.data.qpos, self._at["slide"], scale=-1.0, offset=self.pusher_start)
        places = {
            "probe": Cell(
                self.data.qpos, self._at["slide"], scale=-1.0, offset=self.pusher_start - p.probe_at_pusher
            ),
            "pusher": pusher,
        }
        speed = Cell(self.data.qvel, self._at["slide"], scale=-1.0)
        surfaces = {
            "probe": wire("probed" if self._contours[1] is not None else "surface"),
            "pusher": wire("surface"),
        }
        collapse = {"probe": wire("probe_collapse"), "pusher": wire("pusher_compression")}
        for name, tip in tips.items():
            inputs = [places[name], speed, surfaces[name], *map(wire, seen)]
            force = [wire(f"{name}_force"), wire("fx", add=True), wire("fy", add=True)]
            circuit.bind(name, tip, inputs, [collapse[name], *force])
        gap = [pusher, wire("surface", scale=-1.0)]
        circuit.bind("pusher_gap", _native.summing_junction(2), gap, [wire("pusher_gap")])
        stroke = _native.limit(
            "the position of the probe", "m", 0.0, p.probe_stroke, "the slide drove the probe into the ring"
        )
        circuit.bind("probe_stroke", stroke, [wire("probe_collapse")], [])

    def _ring(self, circuit: Circuit) -> None:
        p, wire, bind = self.parameters, self.wire, circuit.bind
        angle, rate = self._state("spindle")
        if p.spindle_error > 0.0 or p.spindle_error_noise > 0.0:
            self._errors(circuit, angle)
        states = [self._state(joint) for joint in RING]
        inputs = [angle, rate, *(place for place, _ in states), *(speed for _, speed in states)]
        centre = ["cx", "cy", "vcx", "vcy", "orientation", "turn_rate"]
        outputs = [*map(wire, centre), wire("eccentricity"), wire("slip_speed")]
        bind("ring", _native.turntable(), [*inputs, wire("error_x"), wire("error_y")], outputs)
        self._limits(circuit)
        contour, dirt = self._contours
        met = ["surface", "normal_x", "normal_y", "vx", "vy", "phase"]
        bind("outline", _native.outline(contour.tolist()), [*map(wire, centre)], [*map(wire, met)])
        if dirt is not None:
            bind("dirt", _native.lookup(dirt.tolist()), [wire("phase")], [wire("dirt")])
            bind("probed", _native.summing_junction(2), [wire("surface"), wire("dirt")], [wire("probed")])

    def _errors(self, circuit: Circuit, angle: Cell) -> None:
        p, wire = self.parameters, self.wire
        total = sum(1.0 / n for n in ERROR_ORDERS)
        for axis, phases in self._error_phases.items():
            shares = [
                (p.spindle_error / (n * total), phase) for n, phase in zip(ERROR_ORDERS, phases, strict=True)
            ]
            first = [(0.0, 0.0)] * (ERROR_ORDERS[0] - 1)
            circuit.bind(f"sync_{axis}", _native.harmonics(first + shares), [angle], [wire(f"sync_{axis}")])
            parts = [wire(f"sync_{axis}"), wire(f"async_{axis}")]
            circuit.bind(f"error_{axis}", _native.summing_junction(2), parts, [wire(f"error_{axis}")])

    def _limits(self, circuit: Circuit) -> None:
        p, wire = self.parameters, self.wire
        table, line = p.table_radius - p.feet_radius, LINE_LIMIT * p.radius
        on_table = _native.limit(
            "the eccentricity", "m", 0.0, table, "the ring left the table: spindle too fast or push too hard"
        )
        on_line = _native.limit(
            "the ring's centre beside the line of the probe", "m", -line, line,
            "the line has to meet the ring: lower `plant.eccentricity`",
        )  # fmt: skip
        circuit.bind("table_edge", on_table, [wire("eccentricity")], [])
        circuit.bind("probe_line", on_line, [wire("cy")], [])

    def _spikes(self, steps: int) -> None:
        # one number per reading: this circuit steps when readings are taken
        p, random = self.parameters, self.stream("spikes")
        hit = random.random(steps) < p.spike_fraction
        spikes = np.where(hit, p.spike_height * random.choice((-1.0, 1.0), steps), 0.0)
        inputs = [self.wire("probe_collapse"), Cell(spikes, stride=1)]
        self.sensing.bind("spikes", _native.summing_junction(2), inputs, [self.wire("probe_reading")])

    def _servo(self) -> None:
        p, wire = self.parameters, self.wire
        bandwidth = TURN * p.servo_bandwidth
        board = _native.motion_board(
            p.slide_mass * bandwidth**2,
            2.0 * p.servo_damping * p.slide_mass * bandwidth,
            p.servo_force,
            p.setpoint_period,
        )
        inputs = [wire("position_setpoint"), wire("velocity_setpoint"), *self._state("slide")]
        self.circuit.bind("servo", board, inputs, [Cell(self.data.ctrl, 1)])

    def _friction(self) -> None:
        p, bind = self.parameters, self.circuit.bind
        law = (p.mu_static, p.mu_static / p.mu_ratio, p.stribeck_speed)
        yaw, yaw_rate = self._state("ring_yaw")
        speeds = [self._state("ring_x")[1], self._state("ring_y")[1], yaw_rate]
        if p.bristle:
            stiffness = p.mu_static * self._weight / p.presliding
            damping = 2.0 * p.bristle_damping * math.sqrt(stiffness * p.mass)
            bristle = _native.bristle(self._weight, law, p.feet_radius, stiffness, damping, p.break_away)
            bind("friction", bristle, speeds, [self._force(joint) for joint in RING])
            return
        columns = self.model.pair_friction.shape[1]
        for row, (foot, place) in enumerate(zip(FEET, _feet(p), strict=True)):
            tangents = [Cell(self.model.pair_friction, row * columns + i) for i in range(2)]
            bind(foot, _native.foot(place, law), [yaw, *speeds], tangents)

    def _push(self) -> None:
        # what probe and pusher do to the ring, and the ring to the slide
        wire, bind = self.wire, self.circuit.bind
        inputs = [wire("fx"), wire("fy"), wire("surface"), wire("cx"), wire("cy"), self._state("spindle")[0]]
        joints = [self._force(joint) for joint in ("spindle", *RING)]
        bind("wrench", _native.wrench(), inputs, joints)
        bind("reaction", _native.summing_junction(1), [wire("fx")], [self._force("slide")])

    def _channels(self) -> None:
        p, wire = self.parameters, self.wire
        places = {name: self._state(name)[0] for name in self._at}
        angle, slide = places["spindle"], places["slide"]
        probe = wire("probe_reading" if p.spike_height > 0.0 else "probe_collapse")
        readings = {"spindle_angle": angle, "slide_position": slide, "probe_position": probe}
        commands = {
            "slide_position_setpoint": wire("position_setpoint"),
            "slide_velocity_setpoint": wire("velocity_setpoint"),
        }
        seen = ("eccentricity", "slip_speed", "surface", "probe_force", "pusher_force", "pusher_gap")
        truths = {
            **{joint: places[joint] for joint in RING},
            **{name: wire(name) for name in seen},
            "spindle_angle": angle,
            "slide_position": slide,
            "slide_velocity": self._state("slide")[1],
        }
        self.connect(readings, commands, truths)

    def _state(self, joint: str) -> tuple[Cell, Cell]:
        return Cell(self.data.qpos, self._at[joint]), Cell(self.data.qvel, self._at[joint])

    def _force(self, joint: str) -> Cell:
        return Cell(self.data.qfrc_applied, self._at[joint], add=True)


def _check_together(p: SpindleRingParameters) -> None:
    pairs = (
        ("feet_radius", "radius", p.feet_radius, p.radius),
        ("probe_at_pusher", "probe_stroke", p.probe_at_pusher, p.probe_stroke),
        ("eccentricity", "start_distance", p.eccentricity, p.start_distance),
        ("eccentricity", "radius", p.eccentricity, LINE_LIMIT * p.radius),
        ("eccentricity", "table_radius", p.eccentricity, p.table_radius - p.feet_radius),
    )
    for name, bound, value, limit in pairs:
        if value > limit:
            raise ParameterError(
                f"parameter `plant.{name}` of plant `spindle_ring`: value `{value:g}` m, "
                f"limit `{limit:g}` m\nhint: the limit comes from `plant.{bound}`"
            )


def _feet(p: SpindleRingParameters) -> list[tuple[float, float]]:
    angles = (0.0, TURN / 3.0, 2.0 * TURN / 3.0)
    return [(p.feet_radius * math.cos(angle), p.feet_radius * math.sin(angle)) for angle in angles]


def _outline(p: SpindleRingParameters, random: np.random.Generator) -> NDArray[np.float64]:
    """Radius of the ring over its angle."""
    angle = np.arange(SAMPLES) * (TURN / SAMPLES)
    roughness = p.roughness * math.sqrt(2.0 / len(ROUGHNESS_ORDERS))
    orders = {2: p.lobe_2, 3: p.lobe_3, 5: p.lobe_5, **dict.fromkeys(ROUGHNESS_ORDERS, roughness)}
    radius = np.full(SAMPLES, p.radius)
    for order, amplitude in orders.items():
        radius += amplitude * np.cos(order * angle + random.uniform(0.0, TURN))
    return radius


def _dirt(p: SpindleRingParameters, random: np.random.Generator) -> NDArray[np.float64] | None:
    """Height of the particles over the angle of the ring, none if it is clean."""
    count = math.ceil(p.dirt_fraction * TURN * p.radius / p.dirt_width)
    if p.dirt_height == 0.0 or count == 0:
        return None
    angle = np.arange(SAMPLES) * (TURN / SAMPLES)
    height = np.zeros(SAMPLES)
    for place in random.uniform(0.0, TURN, count):
        distance = p.radius * np.abs((angle - place + math.pi) % TURN - math.pi)
        bump = 0.5 * p.dirt_height * (1.0 + np.cos(TURN * distance / p.dirt_width))
        np.maximum(height, np.where(distance < 0.5 * p.dirt_width, bump, 0.0), out=height)
    return height
