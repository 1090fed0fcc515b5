"""A closed loop as an SSP package: its FMUs, an FMU of the surroundings, and the connections."""
