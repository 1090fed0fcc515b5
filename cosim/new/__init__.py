"""A scenario to start from: an FMU and a plant wired by name and unit, the rest left as comments."""
