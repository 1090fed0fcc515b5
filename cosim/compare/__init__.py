"""Comparison of what was computed with what was computed before: traces, results and sweeps."""
