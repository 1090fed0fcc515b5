"""Execution of runs: in supervised worker processes or in this process."""
