"""Residuals, Jacobians and fits of a hypothesis on windows of the runs, and its cross-validation."""
