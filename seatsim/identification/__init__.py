"""Identification: the parameters of a damper model from records of a damper on a bench."""
