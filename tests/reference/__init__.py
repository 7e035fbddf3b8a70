"""Solved problems to 28 digits and the comparison with them."""
