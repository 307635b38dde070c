"""The numbers of a boat file that data can move: place in the simulator's record, and prior."""
