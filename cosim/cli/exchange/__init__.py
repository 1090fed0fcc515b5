"""Commands that export a scenario to other tools."""
