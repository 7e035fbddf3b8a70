"""One list of all numbers of a run, from which tables, figures and messages are made.

``base`` says what an entry is, ``listed`` has them all, ``values`` how each is computed, ``lookup``
leads from names to values; ``contacts`` computes what events tell, ``between`` what only
close rows of a history tell.
"""
