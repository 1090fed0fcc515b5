"""Many scenarios at once, each held against its criteria: acceptance table, JSON, plots, JUnit XML."""
