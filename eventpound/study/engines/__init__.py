"""What computes the chunks of a study: this process, others here, or a cluster."""
