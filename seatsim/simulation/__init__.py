"""From a scenario and its inputs to outputs: the one way to simulate, on a seat or on a damper bench.

What was measured comes in as inputs only; comparing with measured outputs belongs to `seatsim.recordings`.
"""
