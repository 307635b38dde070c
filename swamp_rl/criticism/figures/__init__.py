"""Model criticism on printed figures: what a boat file gets wrong about numbers that a source prints."""
