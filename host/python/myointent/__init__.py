"""Intent from forearm EMG: model files, the device's pipeline, metrics and recordings as numpy arrays.

Armband: 8 channels, 200 Hz, whole numbers from -128 to 127. Labels are class numbers: 0 relax, 1 open, 2 close,
3 wave-in, 4 wave-out, 5 pinch (`INTENTS`); -1 none or unknown; -2 other movement.
"""

# A numpy that does not work says so here, with its own message, and not where the first array is made.
import numpy as _numpy  # noqa: F401

from ._myointent import (
    INTENTS,
    Calibration,
    Error,
    Event,
    Model,
    Patches,
    Recording,
    Report,
    Smoother,
    Stream,
    __version__,
    calibrate,
    evaluate,
    read,
    score,
)

__all__ = [
    "INTENTS",
    "Calibration",
    "Error",
    "Event",
    "Model",
    "Patches",
    "Recording",
    "Report",
    "Smoother",
    "Stream",
    "calibrate",
    "evaluate",
    "read",
    "score",
]
