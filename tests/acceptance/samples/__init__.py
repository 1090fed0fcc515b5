"""Random samples of the acceptance tests and the runs with them: rings, robots, molds, scenario overrides."""
