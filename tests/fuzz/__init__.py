"""Hostile input: cases and records damaged at random, as tests and as long runs."""
