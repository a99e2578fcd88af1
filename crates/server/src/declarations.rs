//! The page's declarations of what it and the server send each other, `web/src/protocol.ts`, made from the types here.

use crate::{
    difference::{Figures, Metric},
    gallery::Listing,
    kept::AboutReference,
    outline::{Handle, Outline},
    path::{DirectTold, EndTold, KindTold, Told, VertexTold},
    pictures::{AboutPicture, Added, FirstLook, LayerChoice, PicturePixel},
    protocol::{
        AboutScene, AnimationState, CameraState, Choices, Denoiser, Exposure, FrameEnd, FrameKind, Message, Named,
        NodeState, ParameterState, Request, ServerMessage, Settings, SettingsChange, Severity, Size, State,
        Surroundings, ToneChoice, ToneParameter,
    },
    requests::{Pixel, Sample},
};
use ts_rs::{Config, TS};

/// Set to write the file.
const WRITE: &str = "STERADIAN_WRITE";
const HEAD: &str = "/** Messages of server and page. Made from the types of crates/server by its tests with STERADIAN_WRITE=1: not \
                    to be edited. */\n";

/// Declaration of a type, with its comments.
fn declaration<T: TS>(config: &Config) -> String {
    format!("\n{}export {}\n", T::docs().unwrap_or_default(), T::decl(config))
}

/// Text of the file.
fn declarations() -> String {
    let config = Config::new().with_large_int("number");
    let sent = [
        declaration::<Severity>,
        declaration::<Message>,
        declaration::<Named>,
        declaration::<ToneParameter>,
        declaration::<ToneChoice>,
        declaration::<Size>,
        declaration::<Denoiser>,
        declaration::<Choices>,
        declaration::<AboutScene>,
        declaration::<CameraState>,
        declaration::<Settings>,
        declaration::<State>,
        declaration::<FrameKind>,
        declaration::<Exposure>,
        declaration::<AnimationState>,
        declaration::<Surroundings>,
        declaration::<FrameEnd>,
        declaration::<ServerMessage>,
        declaration::<SettingsChange>,
        declaration::<Request>,
        declaration::<ParameterState>,
        declaration::<NodeState>,
        declaration::<Sample>,
        declaration::<Pixel<'static>>,
        declaration::<Handle>,
        declaration::<Outline>,
        declaration::<KindTold>,
        declaration::<DirectTold>,
        declaration::<VertexTold>,
        declaration::<EndTold>,
        declaration::<Told>,
        declaration::<AboutReference>,
        declaration::<Metric>,
        declaration::<Figures>,
        declaration::<Listing>,
        declaration::<LayerChoice>,
        declaration::<AboutPicture>,
        declaration::<PicturePixel<'static>>,
        declaration::<FirstLook>,
        declaration::<Added>,
    ];
    let texts = sent.map(|declaration: fn(&Config) -> String| declaration(&config));
    format!("{HEAD}{}", texts.concat().replace("`None`", "`null`"))
}

#[test]
fn the_page_declares_what_is_sent() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/src/protocol.ts");
    let made = declarations();
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(path, &made).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap();
    assert!(kept == made, "run: {WRITE}=1 cargo test -p steradian-server --lib declares");
}
