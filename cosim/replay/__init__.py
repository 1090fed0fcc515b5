"""Runs shown again from their traces: pictures, films and MuJoCo's viewer."""

from cosim import physics

physics.ready()
