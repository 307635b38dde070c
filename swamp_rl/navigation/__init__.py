"""Navigation: where the boat is and how it moves, from GPS and AHRS, and from its model when they fail."""
