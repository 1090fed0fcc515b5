"""Acceptance runs of many scenarios: table of criteria, JSON, plots and JUnit XML."""
