"""Measured, not claimed: quality and speed beside other libraries."""
