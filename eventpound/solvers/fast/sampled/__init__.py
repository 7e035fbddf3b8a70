"""Steps of several bodies under a record; the door is `steps`."""
