"""Figures of a diagnosis, as pictures with title and caption for the report; nothing here writes HTML."""
