from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    "__version__",
    "calibrate",
    "evaluate",
    "read",
    "score",
]

INTENTS: Final[tuple[str, ...]]
__version__: Final[str]

class Error(ValueError): ...

@final
class Model:
    def __new__(cls, file: str | PathLike[str] | bytes, name: str | None = None) -> Model: ...
    def __reduce__(self) -> tuple[type[Model], tuple[bytes, str]]: ...
    @property
    def name(self) -> str: ...
    @property
    def content(self) -> bytes: ...
    @property
    def classes(self) -> tuple[str, ...]: ...
    def predict(
        self, emg: ArrayLike, *, emitted: bool = False
    ) -> tuple[NDArray[np.int8], NDArray[np.float32]]: ...

@final
class Calibration:
    @property
    def person(self) -> str: ...
    @property
    def rounds(self) -> int: ...
    @property
    def other_movement(self) -> bool: ...
    @property
    def before(self) -> float: ...
    @property
    def after(self) -> float: ...
    @property
    def model(self) -> Model | None: ...

@final
class Event:
    @property
    def line(self) -> str: ...
    @property
    def kind(self) -> Literal["label", "state", "alignment"]: ...
    @property
    def label(self) -> str | None: ...
    @property
    def valid(self) -> bool | None: ...
    @property
    def strength(self) -> int | None: ...
    @property
    def cause(self) -> str | None: ...
    @property
    def alignment(self) -> str | None: ...
    @property
    def instant(self) -> int | None: ...
    @property
    def emitted(self) -> int | None: ...

@final
class Stream:
    def __new__(
        cls, model: Model, *, align: bool = False, mirrored: bool | None = None
    ) -> Stream: ...
    def push(self, samples: ArrayLike) -> list[Event]: ...

@final
class Patches:
    def __new__(cls, model: Model) -> Patches: ...
    def push(self, samples: ArrayLike) -> NDArray[np.float32]: ...

@final
class Smoother:
    def __new__(cls, model: Model) -> Smoother: ...
    def push(self, logits: NDArray[np.float32]) -> tuple[int, str] | None: ...

@final
class Recording:
    def __new__(
        cls,
        person: str,
        name: str,
        path: str | PathLike[str],
        emg: NDArray[np.int8],
        labels: NDArray[np.int8],
        other_movement: list[tuple[int, int, str]],
        notes: list[str],
    ) -> Recording: ...
    def __reduce__(self) -> tuple[type[Recording], tuple[Any, ...]]: ...
    @property
    def person(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def path(self) -> Path: ...
    @property
    def emg(self) -> NDArray[np.int8]: ...
    @property
    def labels(self) -> NDArray[np.int8]: ...
    @property
    def other_movement(self) -> list[tuple[int, int, str]]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def imu(self) -> NDArray[np.float64] | None: ...

@final
class Report:
    def __new__(cls, results: dict[str, Any], text: str) -> Report: ...
    def __reduce__(self) -> tuple[type[Report], tuple[dict[str, Any], str]]: ...
    @property
    def results(self) -> dict[str, Any]: ...

def read(
    path: str | PathLike[str],
    *,
    strict: bool = False,
    label_lag: Literal["none", "each-cue", "estimated"] = "none",
    as_recorded: bool = False,
) -> list[Recording]: ...
def calibrate(
    model: Model,
    path: str | PathLike[str],
    *,
    person: str | None = None,
    show_others: bool = False,
    strict: bool = False,
    as_recorded: bool = False,
) -> Calibration: ...
def evaluate(
    model: Model,
    path: str | PathLike[str],
    *,
    people: list[str] = ...,
    seen: bool = False,
    test_people: bool = False,
    strict: bool = False,
    label_lag: Literal["none", "each-cue", "estimated"] = "each-cue",
    as_recorded: bool = False,
    report: str | PathLike[str] | None = None,
) -> Report: ...
def score(
    truth: ArrayLike,
    prediction: ArrayLike,
    *,
    emitted: ArrayLike | None = None,
    delay: int = 0,
    buffer: int = ...,
    strict: bool = False,
    allow_relax: bool = False,
) -> Report: ...
