//! Directives that change the current transform.

use super::{
    reader::{Done, Reader},
    state::Active,
};
use steradian_math::DVec3;
use steradian_scene::{Span, Transform};

impl Reader<'_> {
    /// Carries out one of the directives named in the match.
    pub(super) fn transform(&mut self, word: &str, span: Span) -> Done {
        match word {
            "Identity" => {
                self.state.change(|_| Transform::IDENTITY);
            }
            "Translate" => {
                let v = self.numbers::<3>()?;
                self.state.concat(Transform::translate(v.into()));
            }
            "Scale" => {
                let v = self.numbers::<3>()?;
                self.state.concat(Transform::scale(v.into()));
            }
            "Rotate" => {
                let [angle, x, y, z] = self.numbers::<4>()?;
                let axis = DVec3::new(x, y, z);
                if axis.try_normalize().is_none() {
                    return self.refuse(span, "the axis of the rotation has no length");
                }
                self.state.concat(Transform::rotate(axis, angle.to_radians()));
            }
            "LookAt" => {
                let [ex, ey, ez, lx, ly, lz, ux, uy, uz] = self.numbers::<9>()?;
                let (eye, look, up) = (DVec3::new(ex, ey, ez), DVec3::new(lx, ly, lz), DVec3::new(ux, uy, uz));
                let camera = Transform::look_at(eye, look, up).and_then(|t| t.inverse());
                let Some(camera_from_world) = camera else {
                    return self
                        .refuse(span, "LookAt needs two different points and an up vector that is not along the view");
                };
                self.state.concat(camera_from_world);
            }
            "Transform" => {
                let m = self.matrix(span)?;
                self.state.change(|_| m);
            }
            "ConcatTransform" => {
                let m = self.matrix(span)?;
                self.state.concat(m);
            }
            "CoordinateSystem" => {
                let (name, _) = self.quoted()?;
                self.coordinate_systems.insert(name, self.state.ctm);
            }
            "CoordSysTransform" => {
                let (name, span) = self.quoted()?;
                match self.coordinate_systems.get(&name) {
                    Some(&ctm) => self.state.ctm = ctm,
                    None => {
                        let help =
                            self.scene.report.did_you_mean(&name, self.coordinate_systems.keys().map(String::as_str));
                        let message = format!("there is no coordinate system '{name}'");
                        self.scene.report.error_help(span, message, help);
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    pub(super) fn active_transform(&mut self) -> Done {
        let token = self.token()?;
        let lexer = self.lexer();
        self.state.active = match lexer.bytes(token) {
            b"All" => Active::All,
            b"StartTime" => Active::Start,
            b"EndTime" => Active::End,
            _ => {
                let (span, found) = (lexer.token_span(token), lexer.excerpt(token));
                return self.refuse(span, format!("expected All, StartTime or EndTime, found '{found}'"));
            }
        };
        Ok(())
    }
}
