"""Orthogonal robot: three ball-screw axes that press and move a small ball of wood over a lens mold.

The machine is that of Nagata, Mizobuchi, Tani, Hase, Haga, Watanabe and Habib, "Stick-Slip Motion Control
for an Orthogonal-Type Robot" (2010). The paper gives strokes, pulses of 1 um, 1 ms, 178 N/mm, the ball of
1 mm and the width of the mold, but no mass, servo, friction or force. Those are choices with a source.

The world frame has z up and its origin where the axis of a mold without misalignment meets its surface.
Joints are at zero where the ball is at the start. Forces are those on the tool.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import machining_native as _native
from machining_native import Cell
from plants.base.plant import Array, Channel, Plant, vector
from plants.looks import orthogonal_robot as looks
from plants.orthogonal_robot_parameters import (
    IMPEDANCE,
    TURN,
    OrthogonalRobotParameters,
    check_together,
)
from plants.tools.molds import MOLDS

AXES = ("x", "y", "z")


class OrthogonalRobot(Plant):
    """The machine. Channels: three encoders, a force sensor and pulses; see the tables below."""

    Parameters: ClassVar[type] = OrthogonalRobotParameters
    wires: ClassVar[tuple[str, ...]] = (
        "pulses_x", "pulses_y", "pulses_z", "enable", "mold_lift", "lift",
        "reference_x", "reference_y", "reference_z", "force_x", "force_y", "force_z",
        "normal_x", "normal_y", "normal_z",
        "contact_x", "contact_y", "contact_z", "distance",
        "load", "friction_x", "friction_y", "friction_z", "speed", "slid", "rubbed", "work",
    )  # fmt: skip

    def name_channels(self, p: OrthogonalRobotParameters) -> None:
        """Name the channels, with noise, resolution and limits of the parameters."""
        check_together(p)
        self.readings = (
            *vector("position", "m", "Encoders: center of the ball without the bend of the tip",
                     quantum=p.encoder_resolution),
            *vector("force", "N", "Force sensor: force on the tool, weight of the tip included",
                     noise=p.force_noise, quantum=p.force_resolution),
        )  # fmt: skip
        self.commands = (
            *vector("pulses", "1", "Pulses of this tick", quantum=1.0),
            Channel("enable", "1", "Servo on; 0 switches the motors off, the axes coast", start=1.0),
            Channel("mold_lift", "m", "Lift of the mold along its axis"),
        )
        self.truths = (
            Channel("contact_force", "N", "Normal force of the mold on the ball, last plant step"),
            *vector("friction", "N", "Friction of the mold on the ball, last plant step"),
            Channel("sliding_speed", "m/s", "Speed of the ball along the mold while they touch"),
            Channel("slid", "m", "Sliding distance of the ball"),
            Channel("rubbed", "N.m", "Integral of normal force times sliding speed, for Preston's law"),
            Channel("friction_work", "J", "Work of the friction force"),
            *vector("contact", "m", "Point of the mold next to the ball, in the frame of the mold"),
            *vector("normal", "1", "Unit normal of the mold next to the ball, out of the material"),
            Channel("gap", "m", "Distance from ball to mold, negative under load"),
            *vector("ball", "m", "Center of the ball"),
            *vector("axis", "m", "Encoder position without resolution"),
            *vector("reference", "m", "Position commanded by the pulses"),
            Channel("stiffness", "N/m", "Stiffness of tip and contact in series, along z"),
        )

    def shape(self, spec: Any, p: OrthogonalRobotParameters) -> None:
        """Write masses, strokes, stiffnesses and friction into the MJCF."""
        spec.body("x").pos = self._start()
        axes = zip(AXES, self._masses(), self._strokes(), self._start(), strict=True)
        for axis, mass, stroke, start in axes:
            spec.body(axis).mass = mass
            joint = spec.joint(axis)
            joint.range = -0.5 * stroke - start, 0.5 * stroke - start
            joint.armature = p.screw_mass
            joint.frictionloss = 0.0 if p.drive_rolling_way > 0.0 else p.drive_friction
            joint.damping[0] = p.drive_damping
        self._shape_tip(spec)
        self._shape_contact(spec)

    def _shape_tip(self, spec: Any) -> None:
        p = self.parameters
        spec.body("tip").mass = p.tip_mass
        for axis, share in zip(AXES, (p.tip_lateral, p.tip_lateral, 1.0), strict=True):
            tip, stiffness = spec.joint(f"tip_{axis}"), share * p.tip_stiffness
            tip.stiffness[0] = stiffness
            tip.damping[0] = 2.0 * p.tip_damping * math.sqrt(stiffness * p.tip_mass)
        if p.sensor_turn != 0.0:
            spec.site("sensor").quat = math.cos(0.5 * p.sensor_turn), 0.0, 0.0, math.sin(0.5 * p.sensor_turn)
        # encoders show the center of a ball that hangs
        spec.joint("tip_z").springref = -p.tip_mass * spec.option.gravity[2] / p.tip_stiffness

    def _shape_contact(self, spec: Any) -> None:
        p, pair = self.parameters, spec.pair("contact")
        spec.geom("ball").size[0] = p.ball_radius
        pair.friction[:2] = p.friction
        # a direct reference is divided by the impedance d: with the mass of the tip it gives N/m and N.s/m
        d = p.contact_impedance
        share = (1.0 - d) / p.tip_mass
        pair.solref[:] = -p.contact_stiffness * share, -p.contact_damping * share
        pair.solimp[:2] = d
        # a ball comes to rest as fast, and creeps as much, at any impedance
        rest = d / IMPEDANCE * (1.0 - IMPEDANCE) / p.tip_mass
        pair.solreffriction[:] = -p.contact_stiffness * rest, -p.contact_damping * rest
        spec.option.impratio *= (1.0 - d) / d / ((1.0 - IMPEDANCE) / IMPEDANCE)

    def _masses(self) -> tuple[float, float, float]:
        return self.parameters.mass_x, self.parameters.mass_y, self.parameters.mass_z

    def _strokes(self) -> tuple[float, float, float]:
        return self.parameters.stroke_x, self.parameters.stroke_y, self.parameters.stroke_z

    def _start(self) -> tuple[float, float, float]:
        return self.parameters.start_x, self.parameters.start_y, self.parameters.start_z

    def dress(self, spec: Any, p: OrthogonalRobotParameters, shown: Mapping[str, Array]) -> None:
        """Show the mold under the ball."""
        looks.dress(spec, p, shown)

    def draw(self, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]) -> None:
        """Show the polished path."""
        looks.draw(self, shown, row)

    def begin(self, steps: int) -> None:
        """Bind the elements; only the noise that the harness adds to the measurements is random."""
        self._drives()
        self._sensor()
        self._contact()
        self._mold()
        self._channels()

    def _drives(self) -> None:
        p, wire = self.parameters, self.wire
        loops = p.drive_gain * p.position_gain, p.drive_gain * p.velocity_bandwidth, p.velocity_integral
        feedforward = p.feedforward, TURN * p.feedforward_bandwidth
        masses = self._masses()
        for i, axis in enumerate(AXES):
            # an axis carries all following axes
            inertia = sum(masses[i:]) + p.tip_mass + p.screw_mass
            drive = _native.pulse_drive(loops, feedforward, inertia, p.drive_force, p.pulse, p.pulse_period)
            state = [Cell(self.data.qpos, i), Cell(self.data.qvel, i)]
            inputs = [wire(f"pulses_{axis}"), *state, wire("enable")]
            self.circuit.bind(axis, drive, inputs, [Cell(self.data.ctrl, i), wire(f"reference_{axis}")])
            if p.drive_rolling_way > 0.0:
                friction = _native.rolling_friction(p.drive_friction, p.drive_rolling_way)
                force = Cell(self.data.qfrc_applied, i)
                self.circuit.bind(f"{axis}_friction", friction, [Cell(self.data.qvel, i)], [force])

    def _sensor(self) -> None:
        # force on the tool is the opposite of what the robot exerts on the tip
        for axis, force in zip(AXES, self._cells_of("sensor", -1.0), strict=True):
            filtered = _native.low_pass(TURN * self.parameters.force_bandwidth)
            self.circuit.bind(f"force_{axis}", filtered, [force], [self.wire(f"force_{axis}")])

    def _contact(self) -> None:
        # before the plane moves: the force belongs to the previous plane
        inputs = [*self._cells_of("contact"), *self._wires("normal"), *self._cells_of("velocity")]
        sums = [self.wire(name) for name in ("speed", "slid", "rubbed", "work")]
        outputs = [self.wire("load"), *self._wires("friction"), *sums]
        self.circuit.bind("rubbing", _native.rubbing(), inputs, outputs)
        p = self.parameters
        if p.friction_ratio > 1.0:
            law = (p.friction_ratio * p.friction, p.friction, p.stribeck_speed)
            # a foot without a position: its slip is that of the ball
            still, velocity = self.constant(0.0), self.wire("speed")
            coefficients = [Cell(self.model.pair_friction, i) for i in range(2)]
            slip = [still, velocity, still, still]
            self.circuit.bind("break_away", _native.foot((0.0, 0.0), law), slip, coefficients)

    def _mold(self) -> None:
        p, wire, data, mold = self.parameters, self.wire, self.data, MOLDS[self.parameters.mold]
        self.circuit.bind("lift", _native.slew(0.0, p.lift_rate), [wire("mold_lift")], [wire("lift")])
        plane = _native.tangent_plane(
            (1.0 / mold.cap_radius, 1.0 / mold.saddle_radius),
            [(dimple.x, dimple.y, dimple.depth, dimple.sigma) for dimple in mold.dimples],
            (p.step_place, p.step_height, p.step_width),
            p.mold_radius,
            (p.shift_x, p.shift_y, p.shift_z),
            (p.tilt_x, p.tilt_y, p.tilt_z),
        )
        pose = [Cell(data.mocap_pos, i) for i in range(3)] + [Cell(data.mocap_quat, i) for i in range(4)]
        outputs = [*pose, *self._wires("normal"), *self._wires("contact"), wire("distance")]
        self.circuit.bind("mold", plane, [*self._ball(), wire("lift")], outputs)

    def _channels(self) -> None:
        p, wire, data = self.parameters, self.wire, self.data
        axes = [Cell(data.qpos, i, offset=start) for i, start in enumerate(self._start())]
        references = [
            wire(f"reference_{axis}", offset=start) for axis, start in zip(AXES, self._start(), strict=True)
        ]
        readings = {**_named("position", axes), **_named("force", self._wires("force"))}
        truths = {
            "contact_force": wire("load"),
            **_named("friction", self._wires("friction")),
            "sliding_speed": wire("speed"),
            "slid": wire("slid"),
            "rubbed": wire("rubbed"),
            "friction_work": wire("work"),
            **_named("contact", self._wires("contact")),
            **_named("normal", self._wires("normal")),
            "gap": wire("distance", offset=-p.ball_radius),
            **_named("ball", self._ball()),
            **_named("axis", axes),
            **_named("reference", references),
            "stiffness": self.constant(1.0 / (1.0 / p.tip_stiffness + 1.0 / p.contact_stiffness)),
        }
        single = {name: wire(name) for name in ("enable", "mold_lift")}
        commands = {**_named("pulses", self._wires("pulses")), **single}
        self.connect(readings, commands, truths)

    def _wires(self, name: str) -> list[Cell]:
        return [self.wire(f"{name}_{axis}") for axis in AXES]

    def _ball(self) -> list[Cell]:
        row = 3 * int(self.model.geom("ball").id)
        return [Cell(self.data.geom_xpos, row + i) for i in range(3)]

    def _cells_of(self, sensor: str, scale: float = 1.0) -> list[Cell]:
        row = int(self.model.sensor(sensor).adr[0])
        return [Cell(self.data.sensordata, row + i, scale=scale) for i in range(3)]


def _named(name: str, cells: list[Cell]) -> dict[str, Cell]:
    return {f"{name}_{axis}": cell for axis, cell in zip(AXES, cells, strict=True)}
