"""Results as Markdown, figures, pages and terminal tables."""
