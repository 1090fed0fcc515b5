"""Common parts of sweeps and optimizations: varied parameters, runs, their hashes and the store of rows."""
