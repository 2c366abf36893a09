"""Places in the state vector of the true rig, and in the memory that changes once a step.

Motion is relative: `x = zs - z0` is the deflection of the suspension, `y = zc - zs` that of the cushion.
"""

from __future__ import annotations

(
    X,  # m
    V,  # m/s, x'
    Y,  # m
    W,  # m/s, y'
    CURRENT,  # A, in the winding
    CURRENT_2,  # second state of the coil (A, or A/s for a ringing regulator)
    Z,  # hysteretic variable of Bouc-Wen
    FRICTION,  # linkage friction over its sliding force
    SEAL,  # seal friction over its sliding force
    T_FLUID,  # degC
    T_HOUSING,  # degC
    T_THERMOMETER,  # degC
    BODY,  # m, inner body against the seat
    BODY_V,  # m/s
    BODY2,  # m, second inner body
    BODY2_V,  # m/s
    ZENER,  # m, spring of the memory foam
    COVER,  # friction of the cover over its sliding force
    BUSHING,  # m, spring of the Maxwell bushing
    CREEP,  # m, crept part of the spring's deflection
    BASE,  # m, base against the floor
    BASE_V,  # m/s
    PREYIELD,  # late yield variable, or late speed in m/s
    MAGNETISATION,  # A, slow part of the field
    SAG,  # A, mean current that makes the supply sag
    MOUNT,  # m, stretch of the damper's mount
) = range(26)
STATES = 26

(
    CAVITY_VOLUME,  # m of stroke that the cavity has opened
    RELAYS_MEAN,  # A, mean of the hysteresis relays
    DROPOUT_LEFT,  # s, that the present dropout goes on
    V_FRAME,  # m/s, absolute, as a controller would integrate it
    V_DRIVER,  # m/s, absolute
    V_PISTON,  # m/s, last solution of the damper in series with its mount
) = range(6)
MEMORIES = 6
RELAYS = 40
"""Relays of the discrete Preisach model; with 40 the steps of the field (1/40 of its range) are below the noise."""
