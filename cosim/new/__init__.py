"""A first scenario: an FMU and a plant wired by name and unit, the other ports as comments."""
