"""Reality, simulated independently of the models and the kernel that are tested on it.

`physics` holds the equations of the true rig, `faults` what may depart from nominal, and the modules here what excites
it and what its sensors read. How a set of cases is composed and written does not belong here, nor does any verdict.
"""
