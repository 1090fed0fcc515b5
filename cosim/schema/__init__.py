"""JSON schemas of scenarios, studies and optimizations."""
