"""What the fixed-step methods share: forces over a step, the implicit equations, the record."""
