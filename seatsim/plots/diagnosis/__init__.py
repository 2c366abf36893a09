"""Figures of a diagnosis, as SVG for its report."""
