"""YAML in, a folder of results out, and the command line."""
