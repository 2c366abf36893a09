"""Equations of the true rig and their integration; which parameters depart from nominal is none of its business."""
