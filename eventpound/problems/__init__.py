"""A set of problems with certified answers, for programs in any language (docs/problems.md)."""
