"""Newmark's average acceleration with a contact element at each gap."""
