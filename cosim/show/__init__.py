"""What a reader sees of a loop and its result: tables and plots."""
