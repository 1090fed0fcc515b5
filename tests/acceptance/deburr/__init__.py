"""Variable-speed deburring in closed loop with the robot."""
