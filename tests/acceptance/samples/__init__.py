"""Samples of the acceptance tests and their runs: rings, robots, molds, scenarios with changes."""
