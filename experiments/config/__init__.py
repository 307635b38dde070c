"""Experiment files: their schema, their reading and what they name."""
