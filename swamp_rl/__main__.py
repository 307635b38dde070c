"""`python -m swamp_rl`: the command `swamp-rl`, where its script is not on the path."""

from swamp_rl_command import main

if __name__ == "__main__":
    main()
