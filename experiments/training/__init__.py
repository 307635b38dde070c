"""Data recorded and pilots trained, as an experiment file asks."""
