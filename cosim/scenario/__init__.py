"""Scenarios: a closed loop as data, read from merged TOML files and checked."""
