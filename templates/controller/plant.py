"""A mass on a slide with dry and viscous friction, moved by a force."""

from typing import Any, ClassVar

from machining_native import Cell
from plants.base.plant import Channel, Plant

from .__name___parameters import __Name__Parameters


class __Name__(Plant):
    """The slide. Channels: encoder out, force and load in."""

    Parameters: ClassVar[type] = __Name__Parameters

    def name_channels(self, p: __Name__Parameters) -> None:
        """Name the channels, with noise, resolution and limits from the parameters."""
        self.readings = (
            Channel("position", "m", "Encoder", noise=p.encoder_noise, quantum=p.encoder_resolution),
        )
        self.commands = (
            Channel("force", "N", "Force of the motor", minimum=-p.force_max, maximum=p.force_max),
            Channel("load", "N", "External force"),
        )
        self.truths = (
            Channel("position", "m", "Position of the slide"),
            Channel("velocity", "m/s", "Velocity of the slide"),
        )

    def shape(self, spec: Any, p: __Name__Parameters) -> None:
        """Write the parameters into the MJCF."""
        joint = spec.joint("x")
        spec.body("slide").mass = p.mass
        joint.frictionloss, joint.damping[0] = p.friction, p.damping

    def begin(self, steps: int) -> None:
        """Sample the start position, and connect the channels to MuJoCo's data."""
        p, data = self.parameters, self.data
        data.qpos[0] = self.stream("start").uniform(-p.start_spread, p.start_spread)
        readings = {"position": Cell(data.sensordata)}
        commands = {"force": Cell(data.ctrl), "load": Cell(data.qfrc_applied)}
        truths = {"position": Cell(data.qpos), "velocity": Cell(data.qvel)}
        self.connect(readings, commands, truths)
