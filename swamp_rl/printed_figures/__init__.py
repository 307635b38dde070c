"""Model criticism on printed figures: the difference between a boat file and numbers that a source prints."""
