"""Commands that make something to look at: films, the viewer, the page of results."""
