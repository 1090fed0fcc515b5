"""What the machines look like: nothing of it has mass, touches anything or is in a plant that is stepped."""
