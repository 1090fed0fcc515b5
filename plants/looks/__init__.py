"""Parts that are only drawn: without mass and contact, and not in stepped plants."""
