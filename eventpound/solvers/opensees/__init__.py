"""OpenSeesPy on the same scene, where it is installed: the field's usual tool."""
