"""What a run costs: beside C and general solvers, by damper and length, on several processors, on a cluster.

Here belongs what is timed and how it is compared; each measurement checks first that both sides compute the same.
"""
