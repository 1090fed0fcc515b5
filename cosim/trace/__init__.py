"""Traces: their columns, and the files that hold them."""
