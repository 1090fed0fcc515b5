"""What a result says of itself: quantities and verdicts in words, tables in HTML, data frames."""
