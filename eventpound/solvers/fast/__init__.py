"""The compiled event-driven stepper."""
