"""Moreau–Jean time-stepping: a complementarity problem a step."""
