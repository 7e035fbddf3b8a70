"""Commands and Python calls that are interrupted at random instants."""
