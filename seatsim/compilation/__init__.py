"""How Python functions become machine code, and where that is kept between processes.

No physics: which functions are compiled, and with which models, is the business of `seatsim.kernel` and its callers.
"""
