/** Messages of server and page. Made from the types of crates/server by its tests with STERADIAN_WRITE=1: not to be edited. */

/**
 * Severity of a message.
 */
export type Severity = "error" | "warning" | "note";

/**
 * A message to people.
 */
export type Message = { severity: Severity, 
/**
 * Message, with its place where it is about the scene.
 */
text: string, };

/**
 * A thing with a name.
 */
export type Named = { name: string, doc: string, };

/**
 * A number that a tone curve takes.
 */
export type ToneParameter = { name: string, doc: string, default: number, range: [number, number], };

/**
 * A tone curve.
 */
export type ToneChoice = { name: string, doc: string, encoding: string, parameters: Array<ToneParameter>, };

/**
 * Size of a picture, pixels.
 */
export type Size = { width: number, height: number, };

/**
 * Denoiser.
 */
export type Denoiser = "nlm" | "atrous" | "oidn";

/**
 * Choices for pages.
 */
export type Choices = { integrators: Array<Named>, samplers: Array<Named>, denoisers: Array<Named>, colors: Array<string>, tones: Array<ToneChoice>, layers: Array<Named>, };

/**
 * The scene, as far as pages show it.
 */
export type AboutScene = { name: string, path: string | null, faces: number, lights: number, materials: number, messages: Array<Message>, };

/**
 * The camera.
 */
export type CameraState = { name: string | null, names: Array<string>, kind: string, eye: [number, number, number], target: [number, number, number], up: [number, number, number], 
/**
 * Degrees, of perspective cameras.
 */
fov: number | null, 
/**
 * -1 where it mirrors against `eye`, `target` and `up` in a right-handed world.
 */
handedness: number, moved: boolean, movable: boolean, 
/**
 * Name for edits.
 */
id: string, 
/**
 * World length of one unit along its axis.
 */
unit: number, 
/**
 * Radius of its lens, 0 for a pinhole; `null` where it has no focal distance.
 */
lens: number | null, };

/**
 * Render settings.
 */
export type Settings = { 
/**
 * `NAME` or `NAME:key=value,…`.
 */
integrator: string, 
/**
 * Samples per pixel; of the scene where nothing was chosen.
 */
spp: number, 
/**
 * Sampler; `null` for the one that suits.
 */
sampler: string | null, 
/**
 * `auto`, `rgb` or `spectral`.
 */
color: string, 
/**
 * Random seed; `null` for the scene's.
 */
seed: number | null, 
/**
 * Most scattering events; `null` for the scene's.
 */
maxDepth: number | null, 
/**
 * Denoiser of the finished picture; on the way the quick filter is used. `null` where noise stays.
 */
denoise: Denoiser | null, 
/**
 * Renders the light of each group of lights apart, and sends it along.
 */
lightGroups: boolean, };

/**
 * All that pages know.
 */
export type State = { 
/**
 * Grows with every change of what is shown.
 */
generation: number, scene: AboutScene, film: Size, region: [number, number, number, number] | null, camera: CameraState, settings: Settings, choices: Choices, 
/**
 * Choices of how a model or glTF scene is read.
 */
surroundings: Surroundings | null, 
/**
 * Layers that are sent along.
 */
layers: Array<string>, 
/**
 * Tone curve to begin with, with its exposure, as the command line takes it.
 */
tone: string, exposure: Exposure, paused: boolean, undo: number, redo: number, 
/**
 * Command line that makes the same picture.
 */
command: string, 
/**
 * File name for saving the scene.
 */
saveName: string, };

/**
 * Origin of a picture.
 */
export type FrameKind = "preview" | "render";

/**
 * Exposure to begin with.
 */
export type Exposure = "given" | "needed" | "auto";

/**
 * An animation.
 */
export type AnimationState = { 
/**
 * Its name.
 */
name: string | null, 
/**
 * Times of its first and last key frame, seconds.
 */
times: [number, number], };

/**
 * Choices of how a model or glTF scene is read.
 */
export type Surroundings = { 
/**
 * Definitions as they are.
 */
defines: { [key in string]: string }, 
/**
 * Skies that need no file.
 */
skies: Array<string>, 
/**
 * Backgrounds besides colours, `#rrggbb`.
 */
backgrounds: Array<string>, 
/**
 * Finishes of a model, for `material`.
 */
finishes: Array<string>, 
/**
 * Animations, by which the scene is posed `at` a time.
 */
animations: Array<AnimationState>, };

/**
 * End of a frame, after its tiles.
 */
export type FrameEnd = { generation: number, 
/**
 * Size of this frame: a fraction of the film's while the camera moves.
 */
width: number, height: number, 
/**
 * Position of its first pixel in the whole picture.
 */
origin: [number, number], 
/**
 * The part of the whole picture that it shows: x0, y0, x1, y1, the last two exclusive.
 */
crop: [number, number, number, number], kind: FrameKind, 
/**
 * Samples per pixel, in the mean.
 */
samples: number, target: number, 
/**
 * Relative error, estimated.
 */
error: number | null, seconds: number, done: boolean, 
/**
 * True if noise was removed.
 */
denoised: boolean, 
/**
 * Samples that were not finite and count as black.
 */
nonfinite: number, 
/**
 * Groups of lights whose planes came, in their order.
 */
lightGroups: Array<string>, };

/**
 * Text that the server sends over a page's socket.
 */
export type ServerMessage = { "type": "state" } & State | { "type": "frame" } & FrameEnd | { "type": "message" } & Message | { "type": "reference" } | { "type": "answered" };

/**
 * Change of the render settings; fields that are absent stay.
 */
export type SettingsChange = { integrator?: string, spp?: number | null, sampler?: string | null, color?: string, seed?: number | null, maxDepth?: number | null, denoise?: Denoiser | null, lightGroups?: boolean, width?: number, height?: number, };

/**
 * Request of a page.
 */
export type PageMessage = { "type": "camera", 
/**
 * Position.
 */
eye: [number, number, number], 
/**
 * Point that it looks at.
 */
target: [number, number, number], 
/**
 * Upwards.
 */
up: [number, number, number], 
/**
 * Field of view in degrees, where it is to change.
 */
fov?: number, 
/**
 * True while the hand is still on it: pictures are coarse then.
 */
moving: boolean, } | { "type": "camera-name", 
/**
 * Its name, or its number from 0.
 */
name: string, } | { "type": "camera-reset" } | { "type": "settings" } & SettingsChange | { "type": "region", 
/**
 * Pixels x0, y0, x1, y1, the last two exclusive; `null` for all.
 */
pixels: [number, number, number, number] | null, } | { "type": "layers", 
/**
 * Their names.
 */
names: Array<string>, } | { "type": "edit", 
/**
 * The node's name.
 */
node: string, 
/**
 * The parameter's.
 */
parameter: string, 
/**
 * In Steradian's own language; `null` takes it away.
 */
value: string | null, 
/**
 * True while the hand is still on it: pictures are coarse then, and the next edit of the parameter replaces
 * this one.
 */
moving: boolean, } | { "type": "define", 
/**
 * Its name.
 */
name: string, 
/**
 * Value; `null` for the reader's own.
 */
value: string | null, 
/**
 * True while the hand is still on it: pictures are coarse then.
 */
moving: boolean, } | { "type": "undo" } | { "type": "redo" } | { "type": "pause", 
/**
 * Stops if true, goes on if false.
 */
on: boolean, };

/**
 * A parameter of a node.
 */
export type ParameterState = { name: string, 
/**
 * In Steradian's own language; `null` where the default counts.
 */
value: string | null, default: string, type: string, unit: string, range: [number | null, number | null] | null, doc: string, words: Array<string>, };

/**
 * A node of the scene.
 */
export type NodeState = { id: string, family: string, kind: string, parameters: Array<ParameterState>, };

/**
 * Value of a channel.
 */
export type Sample = number | string;

/**
 * Data of a pixel.
 */
export type Pixel = { x: number, y: number, generation: number, kind: FrameKind, samples: number, error: number | null, object: string | null, material: string | null, light: string | null, 
/**
 * True if it is known which surface is there, if any.
 */
hasSurface: boolean, channels: { [key in string]: Sample }, };

/**
 * Point of a shape in the picture, and the axes of the world there.
 */
export type Handle = { 
/**
 * Place in the whole picture, pixels.
 */
at: [number, number], 
/**
 * Pixels by which a point moves in the picture for each unit along x, y and z.
 */
axes: [[number, number], [number, number], [number, number]], };

/**
 * The pixels of a shape, in runs.
 */
export type Outline = { generation: number, 
/**
 * Upper left corner of the first pixel, in pixels of the whole picture.
 */
origin: [number, number], 
/**
 * Size of a pixel here, in pixels of the whole picture.
 */
pixel: [number, number], 
/**
 * Row, first column, and the column after the last.
 */
runs: Array<[number, number, number]>, 
/**
 * Handle by which the shape is moved, where it is placed once.
 */
handle: Handle | null, };

/**
 * Kind of a vertex.
 */
export type VertexKind = "camera" | "surface" | "medium" | "escaped";

/**
 * A light sample.
 */
export type LightSample = { 
/**
 * The point on the light, of lights that are not infinite.
 */
position: [number, number, number] | null, place: [number, number] | null, 
/**
 * The unit direction to it in the picture.
 */
onwards: [number, number] | null, light: [number, number, number], };

/**
 * Vertex of a path as a page draws it.
 */
export type PathVertex = { kind: VertexKind, position: [number, number, number], normal: [number, number, number] | null, object: string | null, material: string | null, 
/**
 * In the picture, pixels from its left upper corner; `null` behind the camera.
 */
place: [number, number] | null, 
/**
 * The unit direction in the picture in which the path goes on.
 */
onwards: [number, number] | null, weight: [number, number, number], emitted: [number, number, number], direct: LightSample | null, event: string | null, };

/**
 * Reason for which a path ends.
 */
export type PathEnd = "escaped" | "absorbed" | "depth" | "roulette" | "not finite" | "too long";

/**
 * Path as a page draws it.
 */
export type TracedPath = { x: number, y: number, sample: number, generation: number, 
/**
 * `path` or `volpath`, and whether the picture is made by it.
 */
tracer: string, of_picture: boolean, 
/**
 * Contribution of the sample to the pixel.
 */
value: [number, number, number], end: PathEnd, vertices: Array<PathVertex>, };

/**
 * Description of a reference for pages.
 */
export type AboutReference = { 
/**
 * Name.
 */
name: string, 
/**
 * Pixels.
 */
width: number, 
/**
 * Pixels.
 */
height: number, 
/**
 * The part of the full picture that it shows, x0, y0, x1, y1; `null` of files.
 */
crop: [number, number, number, number] | null, };

/**
 * Metric of the difference of pixels.
 */
export type Metric = "flip" | "relative" | "absolute";

/**
 * Header of a map of differences: its subject and its figures; those that are not finite are `null`.
 */
export type Figures = { metric: Metric, generation: number, crop: [number, number, number, number], samples: number, 
/**
 * Mean of the map's values.
 */
mean: number | null, 
/**
 * Value that 95 % of them do not exceed.
 */
quantile95: number | null, relmse: number | null, 
/**
 * Decibels, of display values without a tone curve.
 */
psnr: number | null, };

/**
 * Picture of the list for pages.
 */
export type Listing = { 
/**
 * Its number, which stays.
 */
id: number, 
/**
 * Its path, as it was given.
 */
name: string, 
/**
 * Grows with each change of the file.
 */
version: number, 
/**
 * Reason why it cannot be shown; `null` where none is known.
 */
fault: string | null, };

/**
 * A layer or a channel.
 */
export type LayerChoice = { 
/**
 * Its name in the file.
 */
name: string, 
/**
 * Description.
 */
doc: string, };

/**
 * Description of a picture for pages; its tiles follow.
 */
export type AboutPicture = { id: number, 
/**
 * Path.
 */
name: string, 
/**
 * Version of its file.
 */
version: number, 
/**
 * Pixels.
 */
width: number, 
/**
 * Pixels.
 */
height: number, 
/**
 * The layer that comes.
 */
layer: string, 
/**
 * Layers and channels that can be asked for.
 */
layers: Array<LayerChoice>, 
/**
 * Notes about reading the file.
 */
notes: Array<string>, };

/**
 * Values of all channels of a pixel, as exact as the file has them.
 */
export type PicturePixel = { x: number, y: number, channels: { [key in string]: Sample }, };

/**
 * Display of the first picture.
 */
export type FirstLook = { 
/**
 * Tone curves that can be chosen.
 */
tones: Array<ToneChoice>, 
/**
 * Tone curve to begin with, with its exposure.
 */
tone: string, 
/**
 * Exposure to begin with.
 */
exposure: Exposure, };

/**
 * Pictures that were dropped on the page.
 */
export type Added = { 
/**
 * Numbers of those that are on the list now.
 */
added: Array<number>, };
