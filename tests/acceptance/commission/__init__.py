"""Unmeasured machines, before and after the state `Commission`."""
