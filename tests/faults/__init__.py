"""Fault matrices of the controllers: what is injected, what is found of it, and how far the machine moves."""
