"""A scene as arrays, and the laws that move it."""
