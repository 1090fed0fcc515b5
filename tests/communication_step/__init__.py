"""Measured effect of communication step and delay on the closed loops: `docs/communication-step.md`."""
