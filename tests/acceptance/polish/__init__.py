"""Polishing with stick-slip motion in closed loop with the robot."""
