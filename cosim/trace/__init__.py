"""Traces: columns and files."""
