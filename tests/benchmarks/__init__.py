"""Commands that measure work, time and memory and print tables; docs/measured has them."""
