"""The rotary fast tool servo in closed loop with its machine."""
