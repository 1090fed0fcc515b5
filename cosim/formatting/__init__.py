"""Formatting of results: quantities, verdicts, HTML tables, data frames and strict JSON."""
