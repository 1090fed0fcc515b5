"""Replay of runs from their traces: pictures, videos and MuJoCo's viewer."""

from cosim import physics

physics.ready()
