"""CVODE of the SUNDIALS library that scikit-sundae brings along."""
