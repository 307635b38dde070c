"""False alarms, delays and names of the live monitor."""
