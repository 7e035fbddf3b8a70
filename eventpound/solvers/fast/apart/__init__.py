"""Bodies that go apart, each by steps of its own; the door is `steps`."""
