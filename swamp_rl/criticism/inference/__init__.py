"""Conclusions from the selected hypothesis: estimates, shares, rivals, residual force."""
