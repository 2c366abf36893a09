"""Control laws for semi-active seats, and their design.

    laws/            what is asked at every sample, one file per family; nothing else stands there
    optimal          Riccati regulator, Kalman filter, predictive planning: theory that several laws share
    synthesis/       H-infinity static output feedback of any linear plant, with a certificate
    seat_plant       the seat as a plant for synthesis

What belongs to the rig and is the same for every law (noise, delay, coil, inverse damper) stands in `seatsim`, which
never imports this package: it finds laws through the entry point `laws`.
"""

from controllers.synthesis import Design, GeneralisedPlant, synthesise

__all__ = ["Design", "GeneralisedPlant", "synthesise"]
