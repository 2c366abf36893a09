"""Identification: the parameters of a damper model from records of a damper on a bench.

Here belong the free parameters as a vector, the cost, the search, what the data say of the parameters, and the
assessment on records that were held out. Reading bench tables (`seatsim.recordings`), the models themselves
(`seatsim.dampers`), and what a bench shows without a model (`seatsim.characterisation`) do not.
"""
