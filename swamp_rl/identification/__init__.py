"""Identification as the papers do it: regressions on measured motion, as baselines with intervals."""
