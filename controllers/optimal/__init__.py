"""Linear-quadratic optimal control of the linear seat: regulator, Kalman filter, predictive planning.

What belongs here is solved by a Riccati equation or a quadratic programme and serves several laws; the laws themselves
stand in `controllers.laws`, H-infinity design in `controllers.synthesis`.
"""
