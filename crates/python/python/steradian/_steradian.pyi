"""The native part of steradian."""

import os
from collections.abc import Callable, Sequence
from typing import Any, Optional, Union, final

import numpy as np
from numpy.typing import NDArray

StrPath = Union[str, os.PathLike[str]]

class SceneError(ValueError):
    """A scene that has errors; the text has every one of them with its line and carets."""

__version__: str

def read_image(path: StrPath) -> Image:
    """A picture from a file (.exr, .hdr, .pfm, .png, .jpg, …) as linear planes; every channel of an EXR file is kept."""

def registry() -> dict[str, dict[str, str]]: ...
def spectrum(name: str, wavelengths: NDArray[np.float32]) -> NDArray[np.float32]: ...

@final
class Message:
    kind: str
    message: str
    path: Optional[str]
    line: Optional[int]
    column: Optional[int]
    help: Optional[str]
    text: str

@final
class Parameter:
    node: str
    name: str
    value: Any
    default: str
    type: str
    unit: str
    range: Optional[tuple[float, float]]
    doc: str

@final
class Progress:
    fraction: float
    spp: float
    seconds: float

@final
class Image:
    width: int
    height: int
    spp: float
    seconds: float
    error: Optional[float]
    stopped: Optional[str]
    @property
    def shape(self) -> tuple[int, int, int]: ...
    @property
    def channels(self) -> list[str]: ...
    @property
    def layers(self) -> list[str]: ...
    def __getitem__(self, name: str) -> NDArray[np.float32]: ...
    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]: ...
    def layer(self, name: str = "") -> NDArray[np.float32]: ...
    def save(self, path: StrPath, *, tonemap: Optional[str] = None, exposure: Optional[float] = None, half: bool = False) -> None: ...
    def png(self, *, tonemap: Optional[str] = None, exposure: Optional[float] = None) -> bytes: ...
    def to_uint8(self, *, tonemap: Optional[str] = None, exposure: Optional[float] = None) -> NDArray[np.uint8]: ...
    def compare(self, reference: Image) -> dict[str, Any]: ...
    def _repr_png_(self) -> bytes: ...

@final
class Material:
    @staticmethod
    def describe(
        kind: str, parameters: Sequence[tuple[str, str]], *, wavelengths: Optional[Sequence[float]] = None
    ) -> Material: ...
    def evaluate(
        self, wo: NDArray[np.float32], wi: NDArray[np.float32], *, uv: tuple[float, float] = (0.5, 0.5)
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...

@final
class Scene:
    @staticmethod
    def load(
        path: StrPath, *, defines: dict[str, str] = ..., search: Sequence[StrPath] = ..., strict: bool = False
    ) -> Scene: ...
    @staticmethod
    def parse(
        text: str, *, format: Optional[str] = None, name: str = "text", search: Sequence[StrPath] = ..., strict: bool = False
    ) -> Scene: ...
    @property
    def messages(self) -> list[Message]: ...
    @property
    def nodes(self) -> list[tuple[str, tuple[str, str]]]: ...
    @property
    def cameras(self) -> list[str]: ...
    def parameters(self, node: str) -> list[str]: ...
    def params(self) -> list[Parameter]: ...
    def get(self, node: str, parameter: str) -> Any: ...
    def set_text(self, node: str, parameter: str, value: str) -> None: ...
    def text(self, path: StrPath) -> tuple[str, list[tuple[os.PathLike[str], bytes]]]: ...
    def save(self, path: StrPath) -> list[Message]: ...
    def material(self, name: str, *, color: str = "auto") -> Material: ...
    def render(
        self, *, spp: Optional[int] = None, size: Optional[tuple[int, int]] = None, crop: Optional[Sequence[int]] = None,
        camera: Optional[str] = None, integrator: Optional[str] = None, sampler: Optional[str] = None,
        max_depth: Optional[int] = None, seed: Optional[int] = None, threads: int = 0, color: str = "auto", adaptive: bool = False,
        error: Optional[float] = None, time: Optional[float] = None, layers: Sequence[str] = (),
        transparent: bool = False,
        progress: Optional[Callable[[Progress], Any]] = None,
    ) -> Image: ...
