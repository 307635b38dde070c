"""Identification of a boat file: its numbers fitted to recorded runs by output error, under priors."""
