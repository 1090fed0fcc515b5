"""Presentation of scenarios and results: tables and plots."""
