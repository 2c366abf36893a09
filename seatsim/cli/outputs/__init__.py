"""Files that the commands write, one module a kind of result."""
