"""Reality, simulated independently of the models and the kernel that are tested on it.

`rig` puts the equations of `damper`, `seat` and `coil` together, `faults` says what may depart from nominal, and
`excitation` and `experiment` what excites the rig and what its sensors read. How a set of cases is composed and written
does not belong here, nor does any verdict.
"""
