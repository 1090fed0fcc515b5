"""The command line `cosim`: data on stdout, progress and messages on stderr, exit codes for scripts."""

from cosim.cli.app import main

__all__ = ["main"]
