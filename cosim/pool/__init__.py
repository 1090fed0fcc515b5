"""Where runs are done: supervised worker processes of this machine or of a Dask cluster, or this process."""
