"""Other programs on the same problems, as a competent user writes them for each."""
