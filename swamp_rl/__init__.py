"""A small-craft laboratory: the boat, what departs from it, and the pilots that learn to drive it."""

__version__ = "0.1.0"
