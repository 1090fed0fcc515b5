"""Wires, signals and injections: from names to places, and what happens to a value on its way."""
