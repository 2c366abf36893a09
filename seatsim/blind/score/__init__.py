"""Verdicts compared with sealed labels; it knows the labels' words, and neither how cases are made nor simulated."""
