"""Commands that measure work, time and memory; docs/performance.md holds their tables."""
