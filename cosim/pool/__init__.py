"""Execution of runs: in supervised worker processes of this machine or a Dask cluster, or in this process."""
