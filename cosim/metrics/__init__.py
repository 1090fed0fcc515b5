"""Metrics and criteria: expressions over the columns of a trace, with units."""
