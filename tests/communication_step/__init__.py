"""What communication step and delay do to the closed loops, measured: `docs/communication-step.md`."""
