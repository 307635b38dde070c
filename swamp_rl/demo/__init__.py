"""Recordings to look at: runs side by side over one common time."""
