"""Optimization: the values of some keys at which a loop is best, or most like what was measured."""
