"""Base of all plants: the class, its native circuit, names of the MJCF, parameters."""
