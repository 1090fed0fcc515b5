"""What every plant is made of: the class, its model in native code, names of the MJCF, parameters."""
