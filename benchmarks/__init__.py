"""Measurements of the whole tool, and an independent replay to judge its plans by."""
