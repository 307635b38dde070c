"""The vehicle link: how punctual a helm is, and what is left after faults."""
