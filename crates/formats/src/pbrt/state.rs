//! The graphics state: what `AttributeBegin` saves and `AttributeEnd` restores.

use super::dict::Inherited;
use std::sync::Arc;
use steradian_scene::{ColorSpace, NodeId, Span, Transform};

/// A name that a directive mentions, to be looked up when everything is read.
#[derive(Clone, Debug)]
pub(super) struct NameRef {
    pub name: Arc<str>,
    pub span: Span,
}

/// Material of shapes.
#[derive(Clone, Debug)]
pub(super) enum MaterialRef {
    /// pbrt's default, a diffuse surface that reflects one half.
    Default,
    /// Index of a `Material` directive.
    Index(usize),
    /// Set by `NamedMaterial`.
    Named(NameRef),
}

/// The directives that `Attribute` sets parameters for.
pub(super) const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// Index into [`State::attributes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Shape,
    Light,
    Material,
    Medium,
    Texture,
}

/// Message about objects that cannot move.
pub(super) const STANDS_STILL: &str = "this is rendered as it stands at the beginning of its motion; cameras, shapes and \
     instances move, lights that are no shapes do not";

/// Which of the two transforms directives change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Active {
    All,
    Start,
    End,
}

/// Copied by every `AttributeBegin`, so it owns nothing large.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// The transform to the world at the start and the end of the shutter time.
    pub ctm: [Transform; 2],
    pub active: Active,
    pub reverse_orientation: bool,
    pub space: ColorSpace,
    pub material: MaterialRef,
    pub area_light: Option<NodeId>,
    pub interior: Option<NameRef>,
    pub exterior: Option<NameRef>,
    pub attributes: [Inherited; TARGETS.len()],
}

impl Default for State {
    fn default() -> Self {
        Self {
            ctm: [Transform::IDENTITY; 2],
            active: Active::All,
            reverse_orientation: false,
            space: ColorSpace::Srgb,
            material: MaterialRef::Default,
            area_light: None,
            interior: None,
            exterior: None,
            attributes: Default::default(),
        }
    }
}

impl State {
    /// Changes the active transforms.
    pub fn change(&mut self, f: impl Fn(Transform) -> Transform) {
        let [start, end] = &mut self.ctm;
        if self.active != Active::End {
            *start = f(*start);
        }
        if self.active != Active::Start {
            *end = f(*end);
        }
    }

    /// Applies a transform before the active ones.
    pub fn concat(&mut self, t: Transform) {
        self.change(|ctm| ctm * t);
    }

    /// The transform at the start of the motion.
    pub fn transform(&self) -> Transform {
        self.ctm[0]
    }

    pub fn is_animated(&self) -> bool {
        self.ctm[0] != self.ctm[1]
    }

    pub fn inherited(&self, target: Target) -> Inherited {
        self.attributes[target as usize].clone()
    }

    /// The media on both sides where they differ, which is where a surface changes the medium of a path.
    pub fn medium_boundary(&self) -> Option<(Option<NameRef>, Option<NameRef>)> {
        let name = |m: &Option<NameRef>| m.as_ref().map(|m| m.name.clone());
        (name(&self.interior) != name(&self.exterior)).then(|| (self.interior.clone(), self.exterior.clone()))
    }
}

/// The colour space of a name, in any case of letters.
pub(super) fn color_space(name: &str) -> Option<ColorSpace> {
    COLOR_SPACES.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|&(_, s)| s)
}

/// Names of colour spaces.
pub(super) const COLOR_SPACES: [(&str, ColorSpace); 4] = [
    ("srgb", ColorSpace::Srgb),
    ("dci-p3", ColorSpace::DciP3),
    ("rec2020", ColorSpace::Rec2020),
    ("aces2065-1", ColorSpace::Aces),
];

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::DVec3;

    #[test]
    fn active_transforms() {
        let mut s = State::default();
        let shift = Transform::translate(DVec3::X);
        s.concat(shift);
        assert!(!s.is_animated());
        s.active = Active::End;
        s.concat(shift);
        assert!(s.is_animated());
        assert_eq!(s.transform(), shift);
        assert_eq!(s.ctm[1].point(DVec3::ZERO), DVec3::new(2.0, 0.0, 0.0));
    }

    #[test]
    fn color_space_names_ignore_case() {
        assert_eq!(color_space("ACES2065-1"), Some(ColorSpace::Aces));
        assert_eq!(color_space("sRGB"), Some(ColorSpace::Srgb));
        assert_eq!(color_space("adobe"), None);
    }
}
