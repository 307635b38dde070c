"""What is estimated beside a hypothesis: commands between rows, process noise, random effects."""
