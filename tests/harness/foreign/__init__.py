"""FMUs of others: `cosim` gives the results of FMPy."""
