"""A closed loop as an SSP package: its FMUs, one more for all around them, and the connections."""
