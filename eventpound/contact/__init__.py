"""Contacts: what an instant demands of them, the same for every integrator that comes to it."""
