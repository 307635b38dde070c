"""Model criticism: where a simulated boat departs from measured runs, the named cause, and the gain of
adding it.
"""
