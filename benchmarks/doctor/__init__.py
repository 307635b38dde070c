"""Seeded faults of recorded runs that `swamp-rl runs doctor` finds, and those it sees in sound ones."""
