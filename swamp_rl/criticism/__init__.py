"""Model criticism: what makes a simulated boat differ from measured runs, and the gain of mending it."""
