"""How far a computed motion is from the true one, and what that costs."""
