"""How far answers can be relied upon: certificates, comparisons, error measures."""
