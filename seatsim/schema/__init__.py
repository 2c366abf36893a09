"""What a key of a file is: fields with unit and bounds, names, validation, errors, and how files are read and written.

No physics: nothing here knows of a seat, a damper or a recording.
"""
