"""What is odd about recorded runs, from their statistics: before anyone trains or diagnoses."""
