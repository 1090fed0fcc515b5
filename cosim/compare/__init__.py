"""Comparison of traces, results and sweeps with earlier ones."""
