"""Co-simulation FMUs of FMI 2.0 and 3.0: their files, variables, values and instances."""
