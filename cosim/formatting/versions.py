"""Versions of installed distributions."""

from __future__ import annotations

import functools

PROJECT = "machining-fmus"
"""The distribution that cosim is a part of."""


@functools.cache
def version(distribution: str) -> str:
    """Version of a distribution; empty if it was not installed as one."""
    from importlib import metadata

    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return ""
