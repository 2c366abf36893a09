"""Verdicts compared with sealed labels; uses the labels' words only, not how cases are made or simulated."""
