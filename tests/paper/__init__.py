"""The founding paper held against the package: readings, an independent program, correlations."""
