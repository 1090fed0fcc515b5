"""The closed loop of an FMU and a plant: wired, run by one of the engines, recorded."""
