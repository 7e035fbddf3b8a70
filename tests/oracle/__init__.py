"""An independent program in more than double precision, and certificates held against it."""
