"""The commands, a module for each subject; each reads its options, calls one function of seatsim and shows the answer.

What only one command needs is imported inside it, so that `seatsim --help` does not wait for the compiler.
"""
