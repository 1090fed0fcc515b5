"""The HTML report of scenarios and sweeps: one file without dependencies."""
