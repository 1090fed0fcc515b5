"""Machines that nobody has measured, before and after the state `Commission`."""
