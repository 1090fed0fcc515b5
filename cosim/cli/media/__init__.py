"""Commands with visual output: videos, the viewer and the HTML report."""
