"""What the rows of a sweep say: quantiles, sensitivities, probabilities. Failed runs take no part in any figure.

Here belongs what is worked out from the frame of `seatsim.sweeps.parts`; not how it is drawn or written.
"""
