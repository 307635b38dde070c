"""What a folder of results holds, and how it is read again."""
