"""Checks of files without a run: scenarios, studies and optimizations."""
