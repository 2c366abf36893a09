"""Reports: one HTML file for each answer, with the answer first, which needs no network.

A module for each kind of answer turns its value into a `seatsim.report.blocks.Report` of plain sentences, tables and
pictures; one template (`templates/`) and one script (`assets/`) show every kind. Nothing here draws with matplotlib.
"""
