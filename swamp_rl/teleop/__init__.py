"""People at the helm: a boat that is driven in real time from a web page, and the runs that come of it."""
