"""The closed loop of an FMU and a plant: connections, engines and recording."""
