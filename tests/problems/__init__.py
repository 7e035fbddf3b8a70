"""The problem set: what is frozen, what is packed, what takes part."""
