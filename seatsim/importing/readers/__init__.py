"""Readers by kind of format; each function returns a `DataFile` and knows nothing of rigs and channels."""
