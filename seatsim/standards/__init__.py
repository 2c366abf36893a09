"""Vibration judged by standards: a person's exposure (ISO 2631-1, 2002/44/EC), a seat's test (ISO 10326-1, ISO 7096).

What a standard defines of a signal stands in `seatsim.metrics`; here records and simulated runs are put to it.
"""
