"""Sea trials: automatic ITTC manoeuvres in closed loop, recorded as runs, and what their figures are."""
