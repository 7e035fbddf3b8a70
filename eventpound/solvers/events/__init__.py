"""Events: their table, their location, and the loop that meets them."""
