"""The figures of manoeuvres, from simulated and from measured runs alike."""
