"""Whether the designed trial makes confounded diagnoses unique."""
