"""The vehicle's UDP protocol (thesis 6.2): a virtual vehicle that speaks it, and pilots that drive by it."""

from swamp_rl.link.stream import Sample, samples

__all__ = ["Sample", "samples"]
