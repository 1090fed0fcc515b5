"""The page that tells scenarios and sweeps: one HTML file that needs nothing else."""
