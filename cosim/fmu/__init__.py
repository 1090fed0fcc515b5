"""FMI 2.0 co-simulation FMUs: their files, variables, values and instances."""
