"""The boat under a hypothesis: candidate effects, their simulation over runs, the extended boat file."""
