"""The documents: their commands, their numbers and names, the site that is made of them."""
