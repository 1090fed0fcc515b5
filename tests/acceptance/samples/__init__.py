"""What the acceptance tests draw and run: rings, robots, molds, scenarios with changes."""
