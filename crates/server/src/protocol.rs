//! Protocol of page and server over the socket: JSON texts both ways, and pictures as binary tiles ([`crate::tile`]).

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Colour modes of the computation.
pub const COLORS: [&str; 3] = ["auto", "rgb", "spectral"];

/// Request of a page.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase", deny_unknown_fields)]
#[cfg_attr(test, ts(rename = "PageMessage"))]
pub enum Request {
    /// Moves the camera.
    Camera {
        /// Position.
        eye: [f64; 3],
        /// Point that it looks at.
        target: [f64; 3],
        /// Upwards.
        up: [f64; 3],
        /// Field of view in degrees, where it is to change.
        #[cfg_attr(test, ts(optional))]
        fov: Option<f64>,
        /// True while the hand is still on it: pictures are coarse then.
        #[serde(default)]
        moving: bool,
    },
    /// Chooses a camera of the scene.
    CameraName {
        /// Its name, or its number from 0.
        name: String,
    },
    /// Puts the camera back where the scene has it.
    CameraReset,
    /// Changes how pictures are made.
    Settings(SettingsChange),
    /// Renders a part of the picture only.
    Region {
        /// Pixels x0, y0, x1, y1, the last two exclusive; `None` for all.
        pixels: Option<[u32; 4]>,
    },
    /// Chooses the layers that are sent along.
    Layers {
        /// Their names.
        names: Vec<String>,
    },
    /// Sets a parameter of a node of the scene.
    Edit {
        /// The node's name.
        node: String,
        /// The parameter's.
        parameter: String,
        /// In Steradian's own language; `None` takes it away.
        value: Option<String>,
        /// True while the hand is still on it: pictures are coarse then, and the next edit of the parameter replaces
        /// this one.
        #[serde(default)]
        moving: bool,
    },
    /// Reads a model or glTF scene with another definition (`-D NAME=VALUE`).
    Define {
        /// Its name.
        name: String,
        /// Value; `None` for the reader's own.
        value: Option<String>,
        /// True while the hand is still on it: pictures are coarse then.
        #[serde(default)]
        moving: bool,
    },
    /// Takes the last edit back.
    Undo,
    /// Does it again.
    Redo,
    /// Stops and goes on.
    Pause {
        /// Stops if true, goes on if false.
        on: bool,
    },
}

/// Change of the render settings; fields that are absent stay.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
#[cfg_attr(test, ts(optional_fields))]
#[allow(missing_docs)]
pub struct SettingsChange {
    pub integrator: Option<String>,
    #[serde(deserialize_with = "given")]
    pub spp: Option<Option<u32>>,
    #[serde(deserialize_with = "given")]
    pub sampler: Option<Option<String>>,
    pub color: Option<String>,
    #[serde(deserialize_with = "given")]
    pub seed: Option<Option<u64>>,
    #[serde(deserialize_with = "given")]
    pub max_depth: Option<Option<u32>>,
    #[serde(deserialize_with = "given")]
    pub denoise: Option<Option<Denoiser>>,
    pub light_groups: Option<bool>,
    pub width: Option<u32>,
    pub height: Option<u32>,
}

/// Denoiser.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum Denoiser {
    /// First-order regression.
    Nlm,
    /// The à-trous wavelet filter.
    Atrous,
    /// Open Image Denoise.
    Oidn,
}

/// Tells what is absent from what is `null`.
fn given<'de, T: Deserialize<'de>, D: serde::Deserializer<'de>>(from: D) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(from).map(Some)
}

/// Render settings.
#[derive(Clone, Debug, Default, Serialize, PartialEq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Settings {
    /// `NAME` or `NAME:key=value,…`.
    pub integrator: String,
    /// Samples per pixel; of the scene where nothing was chosen.
    pub spp: u32,
    /// Sampler; `None` for the one that suits.
    pub sampler: Option<String>,
    /// `auto`, `rgb` or `spectral`.
    pub color: String,
    /// Random seed; `None` for the scene's.
    pub seed: Option<u64>,
    /// Most scattering events; `None` for the scene's.
    pub max_depth: Option<u32>,
    /// Denoiser of the finished picture; on the way the quick filter is used. `None` where noise stays.
    pub denoise: Option<Denoiser>,
    /// Renders the light of each group of lights apart, and sends it along.
    pub light_groups: bool,
}

/// The scene, as far as pages show it.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct AboutScene {
    pub name: String,
    pub path: Option<String>,
    pub faces: u64,
    pub lights: usize,
    pub materials: usize,
    pub messages: Vec<Message>,
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, Serialize, PartialEq, Eq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs)]
pub enum Severity {
    Error,
    Warning,
    Note,
}

/// The camera.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct CameraState {
    pub name: Option<String>,
    pub names: Vec<String>,
    pub kind: String,
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub up: [f64; 3],
    /// Degrees, of perspective cameras.
    pub fov: Option<f64>,
    /// -1 where it mirrors against `eye`, `target` and `up` in a right-handed world.
    pub handedness: i32,
    pub moved: bool,
    pub movable: bool,
    /// Name for edits.
    pub id: String,
    /// World length of one unit along its axis.
    pub unit: f64,
    /// Radius of its lens, 0 for a pinhole; `None` where it has no focal distance.
    pub lens: Option<f64>,
}

/// All that pages know.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub struct State {
    /// Grows with every change of what is shown.
    pub generation: u32,
    pub scene: AboutScene,
    pub film: Size,
    pub region: Option<[u32; 4]>,
    pub camera: CameraState,
    pub settings: Settings,
    pub choices: &'static Choices,
    /// Choices of how a model or glTF scene is read.
    pub surroundings: Option<Surroundings>,
    /// Layers that are sent along.
    pub layers: Vec<String>,
    /// Tone curve to begin with, with its exposure, as the command line takes it.
    pub tone: String,
    pub exposure: Exposure,
    pub paused: bool,
    pub undo: usize,
    pub redo: usize,
    /// Command line that makes the same picture.
    pub command: String,
    /// File name for saving the scene.
    pub save_name: String,
}

/// Choices of how a model or glTF scene is read.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Surroundings {
    /// Definitions as they are.
    pub defines: BTreeMap<String, String>,
    /// Skies that need no file.
    pub skies: &'static [&'static str],
    /// Backgrounds besides colours, `#rrggbb`.
    pub backgrounds: &'static [&'static str],
    /// Finishes of a model, for `material`.
    pub finishes: &'static [&'static str],
    /// Animations, by which the scene is posed `at` a time.
    pub animations: Vec<AnimationState>,
}

/// An animation.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct AnimationState {
    /// Its name.
    pub name: Option<String>,
    /// Times of its first and last key frame, seconds.
    pub times: [f64; 2],
}

/// Exposure to begin with.
#[derive(Clone, Copy, Debug, Serialize, PartialEq, Eq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum Exposure {
    /// Exposure of the tone curve.
    Given,
    /// Exposure of the tone curve, or by the picture where it would be white or black.
    Needed,
    /// By the picture.
    Auto,
}

/// Size of a picture, pixels.
#[derive(Clone, Copy, Debug, Default, Serialize, PartialEq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// Choices for pages.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct Choices {
    pub integrators: Vec<Named>,
    pub samplers: Vec<Named>,
    pub denoisers: &'static [Named],
    pub colors: &'static [&'static str],
    pub tones: Vec<ToneChoice>,
    pub layers: Vec<Named>,
}

/// A thing with a name.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct Named {
    pub name: &'static str,
    pub doc: &'static str,
}

/// A tone curve.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct ToneChoice {
    pub name: &'static str,
    pub doc: &'static str,
    pub encoding: &'static str,
    pub parameters: Vec<ToneParameter>,
}

/// A number that a tone curve takes.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct ToneParameter {
    pub name: &'static str,
    pub doc: &'static str,
    pub default: f32,
    pub range: [f32; 2],
}

/// Origin of a picture.
#[derive(Clone, Copy, Debug, Serialize, PartialEq, Eq)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum FrameKind {
    /// Picture at once, by the pipeline or few paths.
    Preview,
    /// Picture of the chosen integrator.
    Render,
}

/// End of a frame, after its tiles.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub struct FrameEnd {
    pub generation: u32,
    /// Size of this frame: a fraction of the film's while the camera moves.
    pub width: u32,
    pub height: u32,
    /// Position of its first pixel in the whole picture.
    pub origin: [u32; 2],
    /// The part of the whole picture that it shows: x0, y0, x1, y1, the last two exclusive.
    pub crop: [u32; 4],
    pub kind: FrameKind,
    /// Samples per pixel, in the mean.
    pub samples: f64,
    pub target: u32,
    /// Relative error, estimated.
    pub error: Option<f64>,
    pub seconds: f64,
    pub done: bool,
    /// True if noise was removed.
    pub denoised: bool,
    /// Samples that were not finite and count as black.
    pub nonfinite: u64,
    /// Groups of lights whose planes came, in their order.
    pub light_groups: Vec<String>,
}

/// A message to people.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct Message {
    pub severity: Severity,
    /// Message, with its place where it is about the scene.
    pub text: String,
}

/// Text that the server sends over a page's socket.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum ServerMessage {
    /// All that pages know, after a change of it.
    State(Box<State>),
    /// End of a frame, after its tiles.
    Frame(FrameEnd),
    /// A message to people.
    Message(Message),
    /// There is another reference, or none.
    Reference,
    /// A request was carried out, and the state with it told, or refused.
    Answered,
}

impl ServerMessage {
    /// JSON text of the message.
    pub fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// An error for people.
    pub fn error(text: String) -> Self {
        Self::Message(Message { severity: Severity::Error, text })
    }
}

/// A node of the scene.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct NodeState {
    pub id: String,
    pub family: &'static str,
    pub kind: String,
    pub parameters: Vec<ParameterState>,
}

/// A parameter of a node.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[allow(missing_docs)]
pub struct ParameterState {
    pub name: String,
    /// In Steradian's own language; `None` where the default counts.
    pub value: Option<String>,
    pub default: &'static str,
    #[serde(rename = "type")]
    pub values: String,
    pub unit: &'static str,
    pub range: Option<[Option<f64>; 2]>,
    pub doc: String,
    pub words: Vec<&'static str>,
}

/// All that is wrong, a line each.
pub fn told(diagnostics: &steradian::scene::Diagnostics) -> String {
    let errors = diagnostics.iter().filter(|d| d.severity == steradian::scene::Severity::Error);
    errors.map(text_of).collect::<Vec<_>>().join("\n")
}

/// Text of a message whose severity is shown beside it.
pub fn text_of(diagnostic: &steradian::scene::Diagnostic) -> String {
    let text = diagnostic.to_string();
    let shown = ["error: ", "warning: ", "note: "].iter().find_map(|severity| text.strip_prefix(severity));
    shown.unwrap_or(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_and_slips_are_refused() {
        let read = |text: &str| serde_json::from_str::<Request>(text);
        let camera = read(r#"{"type":"camera","eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"moving":true}"#).unwrap();
        assert!(matches!(camera, Request::Camera { fov: None, moving: true, eye: [0.0, 0.0, 1.0], .. }));
        assert_eq!(read(r#"{"type":"camera-reset"}"#).unwrap(), Request::CameraReset);
        let settings = |text: &str| match read(text) {
            Ok(Request::Settings(change)) => change,
            other => panic!("{other:?}"),
        };
        let change = settings(r#"{"type":"settings","spp":null,"seed":7,"maxDepth":3}"#);
        assert_eq!((change.spp, change.seed, change.max_depth), (Some(None), Some(Some(7)), Some(Some(3))));
        assert_eq!((change.integrator, change.denoise), (None, None));
        assert_eq!(settings(r#"{"type":"settings","denoise":null}"#).denoise, Some(None));
        assert_eq!(settings(r#"{"type":"settings","denoise":"oidn"}"#).denoise, Some(Some(Denoiser::Oidn)));
        assert!(read(r#"{"type":"settings","denoise":"bilateral"}"#).unwrap_err().to_string().contains("`atrous`"));
        for bad in ["", "{}", "[]", r#"{"type":"quit"}"#, r#"{"type":"pause"}"#, r#"{"type":"settings","sp":1}"#] {
            assert!(read(bad).is_err(), "{bad}");
        }
        assert!(read(r#"{"type":"camera","eye":[0,0],"target":[0,0,0],"up":[0,1,0]}"#).is_err());
    }
}
