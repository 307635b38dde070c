"""Attacks on the package: hostile files, kills and requests, with what they found as counts."""
