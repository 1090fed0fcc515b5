"""Commands with visual output: plots, videos, the viewer and the HTML report."""
