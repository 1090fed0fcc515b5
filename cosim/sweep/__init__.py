"""Sweeps: the cases of a study, on worker processes or a cluster, and their results."""
