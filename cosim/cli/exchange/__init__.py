"""Commands that hand a loop over to other tools."""
