"""What a bench shows of a damper before anything is modelled: loops, energy, asymmetry, offset, response times."""
