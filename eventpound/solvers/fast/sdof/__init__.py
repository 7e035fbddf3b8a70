"""SDOF: a single body, whose kernel is one loop over its numbers; the door is `oscillator`."""
