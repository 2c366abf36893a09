"""Control laws for semi-active seats, their design, and bounds on what any law could reach.

    laws/            what is asked at every sample, one file per family; nothing else stands there
    optimal          Riccati regulator, Kalman filter, predictive planning: theory that several laws share
    synthesis/       H-infinity static output feedback of any linear plant, with a certificate
    clairvoyant/     what the best semi-active damper could have done on a known floor
    seat_plant       the seat as a plant for synthesis
    linear_systems   linear systems, connected and sampled

What belongs to the rig and is the same for every law (noise, delay, coil, inverse damper) stands in `seatsim`, which
never imports this package: it finds laws and bounds through the entry points `laws` and `bounds`.
"""

from controllers.synthesis import Design, GeneralisedPlant, synthesise

__all__ = ["Design", "GeneralisedPlant", "synthesise"]
