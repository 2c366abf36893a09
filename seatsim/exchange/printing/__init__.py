"""Functions of the kernel and its models printed as C99, for other programs: they are written once, in Python."""
