"""Whole experiments, from their file to a folder of results."""
