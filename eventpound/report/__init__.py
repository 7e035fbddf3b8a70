"""Figures and pages of results.

Its modules import matplotlib, which takes a while: they are imported where they are used.
"""
