"""Scenarios: a closed loop as data, read from layers of TOML and checked."""
