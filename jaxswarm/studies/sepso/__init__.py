"""The experiments of the SEPSO paper."""
