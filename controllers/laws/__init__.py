"""Control laws: one file per family, each law a record of its keys that `seatsim.rig.control` describes.

What belongs here is what is asked at every sample, and what makes a law ready for a seat. The theory that laws share
(Riccati equations, estimators) stands in `controllers.optimal`, H-infinity design in `controllers.synthesis`.
Every module of this package is imported with it, so that its laws are registered: a new law is a new file.
"""

import importlib
import pkgutil

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
