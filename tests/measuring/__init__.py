"""That the commands of `tests.benchmarks`, which measure and print, do what they say."""
