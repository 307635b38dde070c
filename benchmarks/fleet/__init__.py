"""A fleet of simulated boats with known faults, diagnosed by `swamp-rl fleet`."""
