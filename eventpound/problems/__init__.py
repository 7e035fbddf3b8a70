"""Problems with certified answers, for programs in any language (page "problems" of the docs)."""
