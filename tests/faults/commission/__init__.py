"""Rows of the fault matrices for controllers that measure their machine."""
