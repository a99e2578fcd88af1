"""Native part of steradian."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
"""Version of the package."""

class SceneError(ValueError):
    """Error of a scene; the text has every one of its errors with line and carets."""

def read_image(path: str | os.PathLike[str]) -> Image:
    """A picture from a file (.exr, .hdr, .pfm, .png, .jpg, …) as linear planes; every channel of an EXR file is kept."""

def registry() -> dict[str, dict[str, str]]:
    """Names of all kinds, family by family, each with its description."""

def own_material(
    name: str,
    eval: Callable[..., ArrayLike],
    sample: Callable[..., ArrayLike] | None,
    pdf: Callable[..., ArrayLike] | None,
    colors: Sequence[tuple[str, Sequence[float]]],
    numbers: Sequence[tuple[str, float]],
    transmits: bool,
    reciprocal: bool,
) -> None:
    """A material of one's own by functions of arrays."""

def own_texture(name: str, function: Callable[..., ArrayLike]) -> None:
    """A texture of one's own by a function of arrays."""

def own_integrator(name: str, function: Callable[[Wave], ArrayLike]) -> None:
    """An integrator of one's own by a function of waves."""

def spectrum(name: str, wavelengths: NDArray[np.float32]) -> NDArray[np.float32]:
    """A spectrum known by name at wavelengths in nm."""

def mesh(scene: Scene, node: str) -> dict[str, Any]:
    """Arrays of a shape's mesh, in its own space; empty ones are left out."""

def set_mesh(scene: Scene, node: str, parts: dict[str, Any]) -> None:
    """Gives a shape another mesh; so to all shapes that share it."""

def placement(scene: Scene, node: str) -> NDArray[np.float64]:
    """Transform of a shape into the world, or its group, 4 × 4."""

def set_placement(scene: Scene, node: str, rows: Sequence[float]) -> None:
    """Sets the transform of a shape, by 16 numbers."""

def trace(
    scene: Scene,
    origins: NDArray[np.float32],
    directions: NDArray[np.float32],
    max_distance: NDArray[np.float32],
    *,
    time: float = 0.0,
) -> dict[str, Any]:
    """Nearest hits of rays, as a dictionary of arrays."""

def occluded(
    scene: Scene,
    origins: NDArray[np.float32],
    directions: NDArray[np.float32],
    max_distance: NDArray[np.float32],
    *,
    time: float = 0.0,
) -> NDArray[np.bool_]:
    """True for rays that meet anything that scatters before their distance."""

def sample_ray(
    scene: Scene, settings: Settings, xy: NDArray[np.float32], lens: NDArray[np.float32], times: NDArray[np.float32]
) -> dict[str, Any]:
    """Camera rays through points of the full frame, as a dictionary of arrays."""

def sample_emitter(
    scene: Scene, points: NDArray[np.float32], normals: NDArray[np.float32], u: NDArray[np.float32], times: NDArray[np.float32]
) -> dict[str, Any]:
    """A light for each point, and a point on it, as a dictionary of arrays."""

def meter(
    scene: Scene,
    points: NDArray[np.float64],
    aims: NDArray[np.float32] | None = None,
    *,
    are_directions: bool = False,
    flux: float | None = None,
    spp: int = 64000,
    error: float | None = None,
    seed: int = 0,
    max_depth: int | None = None,
    integrator: str | None = None,
    color: str = "auto",
) -> dict[str, Any]:
    """Readings of a meter at points, as a dictionary of arrays."""

@final
class Message:
    """Message of reading or compiling."""

    kind: str
    """`error`, `warning`, `note`, or the kind of loss: `approximated`, `dropped`, `unused`."""
    message: str
    """One sentence."""
    path: str | None
    """File, if the message has a place in one."""
    line: int | None
    """Line, from 1."""
    column: int | None
    """Column, from 1, in characters."""
    help: str | None
    """Advice."""
    text: str
    """Whole text, with the line and carets."""

@final
class Parameter:
    """A parameter of a node."""

    node: str
    """The node's name."""
    name: str
    """The parameter's name."""
    value: Any
    """Value; None where the default counts."""
    default: str
    """Default value; empty where the schema does not know the parameter."""
    type: str
    """Type of its values, in words."""
    unit: str
    """Unit; empty for pure numbers."""
    range: tuple[float, float] | None
    """Least and greatest number, or None."""
    doc: str
    """Description."""

@final
class Progress:
    """Progress of a render."""

    fraction: float
    """Fraction of all samples, from 0 to 1."""
    spp: float
    """Samples per pixel so far."""
    seconds: float
    """Seconds so far."""
    image: Image | None
    """Picture so far of a render on other machines; None before its first part, and for renders here."""
    @staticmethod
    def of(parts: Parts) -> Progress:
        """Progress of a render in parts."""

@final
class Settings:
    """Settings of a render: the keyword arguments of `Scene.render`."""

    def __new__(
        cls,
        *,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        crop: Sequence[int] | None = None,
        camera: str | None = None,
        integrator: str | None = None,
        sampler: str | None = None,
        max_depth: int | None = None,
        seed: int | None = None,
        threads: int = 0,
        color: str = "auto",
        adaptive: bool = False,
        error: float | None = None,
        time: float | None = None,
        layers: Sequence[str] = ...,
        transparent: bool = False,
        denoise: str | None = None,
        look_at: Sequence[Sequence[float]] | None = None,
        fov: float | None = None,
        frame: int | None = None,
    ) -> Settings: ...

@final
class Frames:
    """State that each frame of an animation leaves to the next one."""

    def __new__(cls) -> Frames: ...

@final
class Parts:
    """A render in parts, each of which is a range of the pieces that the work falls into."""

    pieces: int
    """Number of pieces."""
    is_done: bool
    """True if all parts are joined."""
    def compute(self, first: int, end: int) -> bytes | None:
        """Computes pieces up to `end`, which is not among them; None if they were stopped."""
    def stop(self) -> None:
        """Ends the computing of pieces, now and later."""
    def join(self, part: bytes) -> None:
        """Joins a part that another process computed."""
    def image(self, stopped: str | None = None) -> Image | None:
        """The picture of the parts that are joined; None before the first. `stopped` is why others are missing."""

@final
class Wave:
    """Camera rays that an integrator of one's own is called with, n of them."""

    origins: NDArray[np.float32]
    """Origins, (n, 3), in the scene's coordinates."""
    directions: NDArray[np.float32]
    """Unit directions, (n, 3)."""
    times: NDArray[np.float32]
    """Moments of the exposure in [0, 1), (n,)."""
    sample: int
    """Number of the sample of each pixel, from zero."""
    def random(self, purpose: int, count: int = 2) -> NDArray[np.float32]:
        """Random numbers in [0, 1), (n, count), count 1 or 2: the same for the same purpose, from 0 to 999, independent for different
        ones, and stratified over the samples of a pixel."""
    def __len__(self) -> int: ...

@final
class View:
    """A page that shows a scene as it was when the view began; it ends when it is closed, or goes away."""

    url: str
    """Address of the page, which holds a secret."""
    def close(self) -> None:
        """Ends the view; a second call does nothing."""
    def __enter__(self) -> View: ...
    def __exit__(self, *_exception: object) -> None: ...
    def _repr_html_(self) -> str:
        """HTML for notebooks: the page in a frame."""

@final
class Image:
    """A picture: planes of linear values by name, rows from the top.

    `Image(planes)` makes one of height × width numbers by name, which are copied; `about` is the `about()` of another one.
    """

    width: int
    """Pixels from left to right."""
    height: int
    """Pixels from top to bottom."""
    spp: float
    """Samples per pixel that were taken."""
    seconds: float
    """Seconds of rendering."""
    error: float | None
    """Estimated relative error, if it is known."""
    stopped: str | None
    """Why the render ended early, if it did: `interrupt`, `time`, `error` or `progress`."""
    def __new__(cls, planes: Mapping[str, ArrayLike], about: Mapping[str, Any] | None = None) -> Image: ...
    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width, and 3 for the colours of the picture."""
    @property
    def channels(self) -> list[str]:
        """Names of the planes, such as R, G, B, albedo.R, N.X, Z."""
    @property
    def layers(self) -> list[str]:
        """Names of the layers; the picture itself is ""."""
    @property
    def metadata(self) -> dict[str, str | float | int | list[float]]:
        """Texts and numbers that a file keeps beside the picture, by name; a copy."""
    def about(self) -> dict[str, Any]:
        """Data of the picture beside its planes."""
    def __getitem__(self, name: str) -> NDArray[np.float32]: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def layer(self, name: str = "") -> NDArray[np.float32]:
        """All planes of a layer in one array of height × width × channels, a copy."""
    def save(
        self,
        path: str | os.PathLike[str],
        *,
        tonemap: str | None = None,
        exposure: float | None = None,
        half: bool = False,
        overwrite: bool = False,
    ) -> None:
        """Writes a file, its format by extension; it appears whole or not at all.

        FileExistsError where `path` is a file that was read for the picture, unless `overwrite` is true.
        """
    def png(self, *, tonemap: str | None = None, exposure: float | None = None) -> bytes:
        """The bytes of a PNG file."""
    def to_uint8(self, *, tonemap: str | None = None, exposure: float | None = None) -> NDArray[np.uint8]:
        """Display values: height × width × 3 numbers from 0 to 255, after exposure and tone curve."""
    def compare(self, reference: Image) -> dict[str, Any]:
        """Figures of the picture against a reference; one of another size is resampled by area."""
    def denoise(self, method: str = "nlm", *, half: Image | None = None, strength: float | None = None) -> Image:
        """The picture without its noise, by "nlm", "atrous" or "oidn", guided by the layers that it has.

        It keeps its layers, and the noisy picture as the layer `raw`. Of nlm alone: `half` is another picture of the view with as
        many samples and another seed; the two guide each other. `strength` is 1 by default; more filters more.
        """
    def mix(self, weights: Mapping[str, float | Sequence[float]]) -> Image:
        """The picture with the lights of groups weighted by name, each by a number or by three; rendered with the layer `light_groups`.

        Groups that are not named count as they are. Of other layers those of first hits stay.
        """
    def _repr_png_(self) -> bytes: ...

@final
class Material:
    """Material as a function of directions."""

    @staticmethod
    def describe(kind: str, parameters: Sequence[tuple[str, str]], *, wavelengths: Sequence[float] | None = None) -> Material:
        """A material by kind, with parameters as words of the command line."""
    def evaluate(
        self, wo: NDArray[np.float32], wi: NDArray[np.float32], *, uv: tuple[float, float] = (0.5, 0.5)
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Values and densities of pairs of directions."""
    def sample(
        self, wo: NDArray[np.float32], u: NDArray[np.float32], *, uv: tuple[float, float] = (0.5, 0.5)
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
        """Sampled directions, weights, densities, relative indices of refraction, and flags of specular lobes."""
    def albedo(self, wo: NDArray[np.float32], *, samples: int = 1024, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[np.float32]:
        """Albedo: the part of the light from each direction that is scattered."""
    def laws(
        self, *, samples: int = 20_000, uv: tuple[float, float] = (0.5, 0.5)
    ) -> list[tuple[str, float | None, float, float, float | None, bool]]:
        """Laws of scattering: law, angle, found, expected, p, holds."""

@final
class Scene:
    """A scene: nodes with parameters, which may be read and set, and rendered again."""

    @staticmethod
    def load(
        path: str | os.PathLike[str],
        *,
        defines: dict[str, str] = ...,
        search: Sequence[str | os.PathLike[str]] = ...,
        strict: bool = False,
    ) -> Scene:
        """Reads a file, or `builtin:NAME`."""
    @staticmethod
    def parse(
        text: str,
        *,
        format: str | None = None,
        name: str = "text",
        search: Sequence[str | os.PathLike[str]] = ...,
        strict: bool = False,
    ) -> Scene:
        """Reads a text in a format; by default the format is recognised by the text."""
    @staticmethod
    def describe(
        text: str,
        *,
        meshes: Sequence[tuple[str, dict[str, Any]]] = ...,
        files: dict[str, bytes] = ...,
        path: str | os.PathLike[str] = "dictionary",
        search: Sequence[str | os.PathLike[str]] = ...,
        strict: bool = False,
    ) -> Scene:
        """Reads a document in Steradian's own language, with meshes and files that are in memory, by their names in it."""
    @property
    def messages(self) -> list[Message]:
        """All messages of reading and compiling so far."""
    @property
    def nodes(self) -> list[tuple[str, tuple[str, str]]]:
        """Families and kinds of all nodes by their names."""
    @property
    def cameras(self) -> list[str]:
        """The names of the cameras."""
    def parameters(self, node: str) -> list[str]:
        """The names of the parameters that a node sets."""
    def params(self) -> list[Parameter]:
        """All parameters of all nodes."""
    def get(self, node: str, parameter: str) -> Any:
        """The value of a node's parameter; None where it is not set."""
    def set_text(self, node: str, parameter: str, value: str) -> None:
        """Sets a parameter to a value in Steradian's own language; `null` takes it away."""
    def text(self, path: str | os.PathLike[str]) -> tuple[str, list[tuple[os.PathLike[str], bytes]]]:
        """The scene in Steradian's own language, for a file at `path`; with the files beside it, by name."""
    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> list[Message]:
        """Writes the scene in the format of the extension; returns messages on approximations and losses."""
    def copy(self) -> Scene:
        """Independent copy of the scene."""
    def view(
        self,
        *,
        integrator: str | None = None,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        denoise: str | None = None,
        bind: str = "127.0.0.1",
        port: int = 0,
    ) -> View:
        """Shows the scene, as it is now, in a page of a server on this machine."""
    def origin(self) -> tuple[os.PathLike[str] | None, list[os.PathLike[str]]]:
        """Path of the scene's file, and the folders that are searched for others."""
    def material(self, name: str, *, color: str = "auto") -> Material:
        """A material by its name, to be evaluated."""
    def framing(self, moments: Sequence[float]) -> list[list[float]] | None:
        """Box that an automatic camera shows at all of some moments of the animation, seconds; None where there is a camera."""
    def moment(self, seconds: float, framing: Sequence[Sequence[float]] | None = None) -> Scene:
        """The scene at a moment of its animation, read anew."""
    def render(
        self,
        settings: Settings,
        progress: Callable[[Progress], Any] | None = None,
        *,
        resume: str | os.PathLike[str] | None = None,
        before: Frames | None = None,
    ) -> Image:
        """Renders the scene."""
    def parts(self, settings: Settings, fingerprint: bytes) -> Parts:
        """A render in parts, of a scene with that fingerprint."""
    def fingerprint(self) -> bytes:
        """Hash of the description, and of the contents of the files that it names."""
    def packed(self) -> tuple[bytes, list[os.PathLike[str]]]:
        """The description in bytes for `unpacked` of the same version, and the files that it names."""
    @staticmethod
    def unpacked(bytes: bytes) -> Scene:
        """The scene that was packed."""
