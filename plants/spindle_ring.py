"""Ring on the table of a vertical spindle, probed and pushed to the center by a slide.

The machine is that of Mears, Kolartis, Thompson and Kurfess, "Design of a Flexible Centering Tooling
System" (2007). The paper gives resolutions, gauging force, slide speed and the range of friction; masses,
radii, stiffness and servo are typical of such machines.

The x axis is the line of the slide, through the spindle; probe and pusher come from +x. Slide position is
positive towards the center, probe position positive when it collapses, the spindle angle positive about +z.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import mujoco
import numpy as np

import machining_native as _native
from machining_native import Cell, Circuit
from plants.base.plant import Array, Channel, Plant, vector
from plants.looks import spindle_ring as looks
from plants.spindle_ring_parameters import LINE_LIMIT, TURN, SpindleRingParameters, check_together
from plants.tools import contour

ROUGHNESS_ORDERS = range(15, 101)
"""Waves of the roughness per revolution."""
ERROR_ORDERS = range(2, 6)
"""Cycles of the error motion per revolution: one cycle is eccentricity by definition."""
TOUCH = 1e-6
"""Deflection at which the probe has its preload, m."""
NOWHERE = -1.0
"""Surface without a ring, m: beyond the travel."""
RING = ("ring_x", "ring_y", "ring_yaw")
FEET = ("foot1", "foot2", "foot3")


class SpindleRing(Plant):
    """Spindle, ring and slide. Channels: three encoders in, two setpoints out; see the tables below."""

    Parameters: ClassVar[type] = SpindleRingParameters
    wires: ClassVar[tuple[str, ...]] = (
        "speed_setpoint", "turning", "swing",
        "position_setpoint", "velocity_setpoint", "enable", "servo", "driven", "braked",
        "async_x", "async_y", "sync_x", "sync_y", "error_x", "error_y",
        "cx", "cy", "vcx", "vcy", "orientation", "turn_rate", "eccentricity", "slip_speed",
        "surface", "normal_x", "normal_y", "vx", "vy", "phase", "dirt", "probed", "fx", "fy",
        "mu", *(f"{kind}_{foot}" for foot in FEET for kind in ("rubs", "patch_x", "patch_y", "patch")),
        "probe_collapse", "probe_force", "probe_reading", "pusher_compression", "pusher_force", "pusher_gap",
    )  # fmt: skip

    def name_channels(self, p: SpindleRingParameters) -> None:
        """Declare the channels with noise, resolution and limits from the parameters."""
        check_together(p)
        probe = {"noise": p.probe_noise, "quantum": p.probe_resolution}
        self.readings = (
            Channel("spindle_angle", "rad", "Encoder of the spindle, unwrapped", quantum=p.angle_resolution),
            Channel("slide_position", "m", "Encoder of the slide", quantum=p.slide_resolution),
            Channel(
                "probe_position", "m", "Encoder of the probe", **probe, minimum=0.0, maximum=p.probe_stroke
            ),
        )
        speed = p.slide_velocity_max
        self.commands = (
            Channel(
                "slide_position_setpoint", "m", "Where the slide should be", minimum=0.0, maximum=p.travel
            ),
            Channel("slide_velocity_setpoint", "m/s", "How fast it should go", minimum=-speed, maximum=speed),
            Channel("enable", "1", "1: the servo drives the slide; 0: shorted windings brake it", start=1.0),
            Channel(
                "spindle_speed_setpoint", "rad/s", "How fast the spindle should turn", start=p.spindle_speed
            ),
        )
        self.truths = (
            *vector("ring", "m", "Center of the ring on the table", "xy"),
            Channel("ring_yaw", "rad", "Angle of the ring on the table"),
            Channel("eccentricity", "m", "Distance of the ring from the axis"),
            Channel("slip_speed", "m/s", "Speed of the ring's center on the table"),
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

    def shape(self, spec: Any, p: SpindleRingParameters) -> None:
        """Write masses and sizes into the MJCF; the bristle replaces the contacts."""
        spec.geom("plate").size[0] = p.table_radius
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

    def dress(self, spec: Any, p: SpindleRingParameters, shown: Mapping[str, Array]) -> None:
        """Place the ring on the table."""
        looks.dress(spec, p)

    def draw(self, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]) -> None:
        """Push the probe in."""
        looks.draw(self, shown, row)

    def begin(self, steps: int) -> None:
        """Place the ring, draw outline, dirt and errors, bind the elements."""
        p = self.parameters
        self._place()
        self._draw()
        if p.spindle_error_noise > 0.0:
            self._asynchronous(steps)
        for circuit in (self.sensing, self.circuit):
            self._touch(circuit)
        if p.spike_height > 0.0:
            self._spikes(steps)
        self._servo()
        self._spindle()
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

    def _draw(self) -> None:
        p = self.parameters
        roughness = p.roughness * math.sqrt(2.0 / len(ROUGHNESS_ORDERS))
        waves = {2: p.lobe_2, 3: p.lobe_3, 5: p.lobe_5, **dict.fromkeys(ROUGHNESS_ORDERS, roughness)}
        self._outline: Array = contour.lobed(p.radius, waves, self.stream("outline"))
        if p.form > 0.0:
            orders = range(round(p.form_first), round(p.form_last) + 1)
            form = dict.fromkeys(orders, p.form * math.sqrt(2.0 / len(orders)))
            self._outline += contour.lobed(0.0, form, self.stream("form"))
        self._dirty = p.part_present and p.dirt_height > 0.0
        self._dirt: Array = contour.dirty(
            p.radius, p.dirt_height, p.dirt_width, p.dirt_fraction, self.stream("dirt")
        )
        random = self.stream("spindle_error")
        self._error_phases = {axis: random.uniform(0.0, TURN, len(ERROR_ORDERS)) for axis in "xy"}

    # elements

    def _asynchronous(self, steps: int) -> None:
        p = self.parameters
        for axis in "xy":
            noise = _native.coloured_noise(p.spindle_error_noise, p.spindle_error_time)
            source = self.normals(f"spindle_error_{axis}", steps)
            self.circuit.bind(f"spindle_error_{axis}", noise, [source], [self.wire(f"async_{axis}")])

    def _touch(self, circuit: Circuit) -> None:
        # position of the ring, forces of probe and pusher: in every step, and when sensors are sampled
        p, wire, bind = self.parameters, self.wire, circuit.bind
        if p.part_present:
            self._ring(circuit)
        damping = 2.0 * p.pusher_damping * math.sqrt(p.pusher_stiffness * p.mass)
        pusher = _native.tip(0.0, TOUCH, p.pusher_stiffness, damping, p.pusher_friction)
        rate = (p.probe_force_full - p.probe_force_free) / p.probe_stroke
        probe = _native.tip(p.probe_force_free, TOUCH, rate, 0.0, p.probe_friction)
        seen, rest = [wire("probed" if self._dirty else "surface")], ["normal_x", "normal_y", "vx", "vy"]
        force = [wire("fx", add=True), wire("fy", add=True)]
        at_pusher, speed = self._tip(0.0)
        inputs = [at_pusher, speed, wire("surface"), *map(wire, rest)]
        bind("pusher", pusher, inputs, [wire("pusher_compression"), wire("pusher_force"), *force])
        inputs = [*self._tip(p.probe_at_pusher), *seen, *map(wire, rest)]
        bind("probe", probe, inputs, [wire("probe_collapse"), wire("probe_force"), *force])
        gap = [at_pusher, wire("surface", scale=-1.0)]
        bind("pusher_gap", _native.summing_junction(2), gap, [wire("pusher_gap")])
        hint = "the slide drove the probe into the ring"
        stroke = _native.limit("the position of the probe", "m", 0.0, p.probe_stroke, hint)
        bind("probe_stroke", stroke, [wire("probe_collapse")], [])

    def _tip(self, ahead: float) -> tuple[Cell, Cell]:
        # position and speed in the world of a point `ahead` of the pusher tip on the slide
        row = self._at["slide"]
        start = self.pusher_start - ahead
        return Cell(self.data.qpos, row, scale=-1.0, offset=start), Cell(self.data.qvel, row, scale=-1.0)

    def _ring(self, circuit: Circuit) -> None:
        p, wire, bind = self.parameters, self.wire, circuit.bind
        angle, rate = self._state("spindle")
        if p.spindle_error > 0.0 or p.spindle_error_noise > 0.0:
            self._errors(circuit, angle)
        states = [self._state(joint) for joint in RING]
        inputs = [angle, rate, *(place for place, _ in states), *(speed for _, speed in states)]
        center = ["cx", "cy", "vcx", "vcy", "orientation", "turn_rate"]
        outputs = [*map(wire, center), wire("eccentricity"), wire("slip_speed")]
        bind("ring", _native.turntable(), [*inputs, wire("error_x"), wire("error_y")], outputs)
        self._limits(circuit)
        met = ["surface", "normal_x", "normal_y", "vx", "vy", "phase"]
        bind("outline", _native.outline(self._outline.tolist()), [*map(wire, center)], [*map(wire, met)])
        if self._dirty:
            bind("dirt", _native.lookup(self._dirt.tolist()), [wire("phase")], [wire("dirt")])
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
            "the distance of the ring center from the line of the probe", "m", -line, line,
            "the line has to meet the ring: lower `plant.eccentricity`",
        )  # fmt: skip
        circuit.bind("table_edge", on_table, [wire("eccentricity")], [])
        circuit.bind("probe_line", on_line, [wire("cy")], [])

    def _spikes(self, steps: int) -> None:
        # one number per sample: this circuit steps when the sensors are sampled
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
            p.servo_integral_time,
        )
        inputs = [wire("position_setpoint"), wire("velocity_setpoint"), *self._state("slide")]
        self.circuit.bind("servo", board, inputs, [wire("servo")])
        # without the drive the shorted windings brake
        braking = Cell(self.data.qvel, self._at["slide"], scale=-p.slide_mass / p.brake_time)
        on, off = wire("enable"), wire("enable", scale=-1.0, offset=1.0)
        self.circuit.bind("drive", _native.product(), [wire("servo"), on], [wire("driven")])
        self.circuit.bind("brake", _native.product(), [braking, off], [wire("braked")])
        both = [wire("driven"), wire("braked")]
        self.circuit.bind("motor", _native.summing_junction(2), both, [Cell(self.data.ctrl, 1)])

    def _spindle(self) -> None:
        p, wire, bind = self.parameters, self.wire, self.circuit.bind
        control, drive = Cell(self.data.ctrl, 0), _native.slew(p.spindle_speed, p.spindle_acceleration)
        if p.spindle_ripple == 0.0:
            bind("spindle_drive", drive, [wire("speed_setpoint")], [control])
            return
        bind("spindle_drive", drive, [wire("speed_setpoint")], [wire("turning")])
        ripple = _native.harmonics([(p.spindle_ripple, self.stream("spindle_ripple").uniform(0.0, TURN))])
        angle = Cell(self.data.qpos, self._at["spindle"], scale=p.spindle_ripple_order)
        bind("spindle_swing", ripple, [angle], [wire("swing")])
        # in parts of the speed, whatever that is
        bind("spindle_ripple", _native.product(), [wire("turning"), wire("swing", offset=1.0)], [control])

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
            if p.mu_spread == 0.0:
                bind(foot, _native.foot(place, law), [yaw, *speeds], tangents)
                continue
            rubs = self.wire(f"rubs_{foot}")
            bind(foot, _native.foot(place, law), [yaw, *speeds], [self.wire("mu"), rubs])
            patch = self._patch(foot)
            for i, tangent in enumerate(tangents):
                bind(f"{foot}_tangent_{i}", _native.product(), [rubs, patch], [tangent])

    def _patch(self, foot: str) -> Cell:
        # friction under a foot over its mean: the ring turns little, so the feet move with its center
        p, random = self.parameters, self.stream(f"patch_{foot}")
        waves = [self.wire(f"patch_{axis}_{foot}") for axis in "xy"]
        for wave, joint in zip(waves, RING[:2], strict=True):
            place = Cell(self.data.qpos, self._at[joint], scale=TURN / p.mu_patch)
            wavy = _native.harmonics([(0.5 * p.mu_spread, random.uniform(0.0, TURN))])
            self.circuit.bind(f"patch {joint} {foot}", wavy, [place], [wave])
        patch = self.wire(f"patch_{foot}", offset=1.0)
        self.circuit.bind(f"patch {foot}", _native.summing_junction(2), waves, [self.wire(f"patch_{foot}")])
        return patch

    def _push(self) -> None:
        # forces of probe and pusher on the ring, and of the ring on the slide
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
            "enable": wire("enable"),
            "spindle_speed_setpoint": wire("speed_setpoint"),
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


def _feet(p: SpindleRingParameters) -> list[tuple[float, float]]:
    angles = (0.0, TURN / 3.0, 2.0 * TURN / 3.0)
    return [(p.feet_radius * math.cos(angle), p.feet_radius * math.sin(angle)) for angle in angles]
