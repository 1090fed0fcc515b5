"""Sweeps: the cases of a study, on worker processes, and their results."""
