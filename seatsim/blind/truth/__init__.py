"""Rigs with hidden effects, written independently of the models and the kernel that are tested on them."""
