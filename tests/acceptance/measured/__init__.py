"""The numbers of the documents: tests measure and keep them, and tables of pages are made of what is kept."""
