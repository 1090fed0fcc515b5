"""Wires, signals and injections: resolution of names, and processing of values."""
