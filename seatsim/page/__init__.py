"""The local page of `seatsim explore`: a scenario or a recording whose values can be moved and seen at once.

`scenario_view` and `recording_view` say what is shown of a request; `app` puts them behind addresses, and decides who
may ask; `serve` binds to loopback. What is shown is made of the blocks, the template and the script of
`seatsim.report`. Needs the extra `page`.
"""
