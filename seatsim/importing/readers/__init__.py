"""One small reader for each format; each returns a `DataFile` and knows nothing of rigs and channels."""
