"""The local page of `seatsim explore`: a scenario or a recording whose values can be moved and seen at once.

`guard` and `folder` decide who may ask and what may be read; `scenario_view` and `recording_view` compute; `app` puts
them behind addresses; `serve` binds to loopback. What is shown is made of the blocks, the template and the script of
`seatsim.report`. Needs the extra `page`.
"""
