"""Comparison of verdicts with the sealed labels."""
