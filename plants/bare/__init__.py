"""A plant from any MJCF file, with channels and parameters of its named elements."""

from plants.bare.plant import Bare, fingerprint, load

__all__ = ["Bare", "fingerprint", "load"]
