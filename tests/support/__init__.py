"""What several test files share: small boats, runs, recorders, jobs that are killed."""
