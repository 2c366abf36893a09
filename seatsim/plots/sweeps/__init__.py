"""Pictures of a sweep: comfort against travel, sensitivities, maps over two keys; none is taller than a screen."""
