"""`python -m swamp_rl.experiments.cli`: the command line without its script."""

from swamp_rl.experiments.cli import main

main()
