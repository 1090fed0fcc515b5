"""`cosim test`: many scenarios in one table."""
