"""A plant of any MJCF file: its channels and parameters are what the file names."""

from plants.bare.plant import Bare, fingerprint, load

__all__ = ["Bare", "fingerprint", "load"]
