"""Optimization: values of keys with the best metric, or the best agreement with a measured trace."""
