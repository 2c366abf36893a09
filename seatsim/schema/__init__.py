"""What a key of a file is: fields with unit and bounds, names, validation, errors, files; how a notebook shows values.

No physics: nothing here knows of a seat, a damper or a recording.
"""
