//! One hostile input and what must come of it.

use std::path::PathBuf;
use steradian::scene::SceneDesc;

/// Expected end of a case.
#[derive(Clone, Copy, Debug)]
pub enum Expect {
    /// An error that says this, in the message, the help or the place; no scene.
    Refused(&'static str),
    /// A finite picture, and a message that says this.
    Warned(&'static str),
    /// A finite picture.
    Picture,
    /// Errors, or a finite picture with a warning.
    Told,
    /// Errors, or a finite picture.
    Either,
}

impl Expect {
    /// Expectation for a scene with this number: infinities and NaN are never passed over in silence.
    pub fn of_number(number: &str) -> Self {
        if ["1e400", "nan", "inf", "-inf"].contains(&number) { Self::Told } else { Self::Either }
    }
}

/// The files of an input, the scene first, and what must come of them.
pub struct Case {
    pub name: String,
    pub files: Vec<(String, Vec<u8>)>,
    pub expect: Expect,
    /// Further folder where files are looked for.
    pub search: Option<PathBuf>,
    /// Replaces the scene's own film by a small one.
    pub small: bool,
    /// The scene where it is made in code; its relative paths are those of the files.
    pub description: Option<SceneDesc>,
}

impl Case {
    /// A case of one file.
    pub fn new(name: impl Into<String>, file: &str, content: impl Into<Vec<u8>>, expect: Expect) -> Self {
        // Models have no film of their own; the one they are given is for pictures, not for tests.
        let small = file.ends_with(".obj") || file.ends_with(".ply");
        Self {
            name: name.into(),
            files: vec![(file.into(), content.into())],
            expect,
            search: None,
            small,
            description: None,
        }
    }

    /// A pbrt scene whose world block is given: a camera and a constant sky are there.
    pub fn pbrt(name: impl Into<String>, world: impl AsRef<str>, expect: Expect) -> Self {
        Self::new(name, "s.pbrt", format!("{PBRT_HEAD}WorldBegin\n{PBRT_SKY}{}", world.as_ref()), expect)
    }

    /// A pbrt scene of a sphere under a sky, with the directives before `WorldBegin` given.
    pub fn pbrt_head(name: impl Into<String>, head: impl AsRef<str>, expect: Expect) -> Self {
        let text = format!("{PBRT_HEAD}{}\nWorldBegin\n{PBRT_SKY}Shape \"sphere\"\n", head.as_ref());
        Self::new(name, "s.pbrt", text, expect)
    }

    /// A Mitsuba scene with the given elements besides a camera and a constant sky.
    pub fn mitsuba(name: impl Into<String>, body: impl AsRef<str>, expect: Expect) -> Self {
        let text = format!("<scene version=\"3.0.0\">\n{MITSUBA_SENSOR}{MITSUBA_SKY}{}\n</scene>\n", body.as_ref());
        Self::new(name, "s.xml", text, expect)
    }

    /// Adds a file beside the scene.
    pub fn with(mut self, file: &str, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((file.into(), content.into()));
        self
    }
}

/// Camera and film of the pbrt cases.
pub const PBRT_HEAD: &str = "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [40]\n\
    Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16]\nSampler \"independent\" \"integer pixelsamples\" [1]\n";

/// A sky.
pub const PBRT_SKY: &str = "LightSource \"infinite\" \"rgb L\" [1 1 1]\n";

/// Camera and film of the Mitsuba cases.
pub const MITSUBA_SENSOR: &str = "<integrator type=\"path\"/>\n<sensor type=\"perspective\">\
    <float name=\"fov\" value=\"40\"/><transform name=\"to_world\"><lookat origin=\"0,0,-5\" target=\"0,0,0\" up=\"0,1,0\"/></transform>\
    <film type=\"hdrfilm\"><integer name=\"width\" value=\"16\"/><integer name=\"height\" value=\"16\"/></film>\
    <sampler type=\"independent\"><integer name=\"sample_count\" value=\"1\"/></sampler></sensor>\n";

/// A sky.
pub const MITSUBA_SKY: &str = "<emitter type=\"constant\"/>\n";

/// Numbers that no scene should hold, as text: not finite, out of the range of `f32` or of 32-bit integers, denormal,
/// zero, negative.
pub const POISON: [&str; 14] = [
    "1e400",
    "nan",
    "inf",
    "-inf",
    "1e39",
    "-1e39",
    "1e38",
    "1e-45",
    "0",
    "-0",
    "-1",
    "1e20",
    "4294967296",
    "-2147483649",
];
