"""Studies: many runs of one case along axes, made once, resumable, on one machine or many."""
