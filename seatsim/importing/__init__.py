"""Measured data from other programs: read from their formats, matched with channels, on one time base, examined.

What belongs here ends with a recording on disk. What a recording shows of its rig is examined in
`seatsim.recordings.quality`.
"""
