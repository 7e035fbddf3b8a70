"""The documentation: tutorials followed, commands and links that exist."""
