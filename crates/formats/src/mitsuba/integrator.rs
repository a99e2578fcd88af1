//! Integrators. Mitsuba's many estimators of one picture become the few that Steradian has for it.
//!
//! | Mitsuba | the picture | Steradian |
//! |---|---|---|
//! | `path` | all light | `path` |
//! | `prb`, `prb_basic`, `prb_projective`, `prb_reparam`, `ptracer` | all light | `path`; `volpath` with media |
//! | `volpath`, `volpathmis`, `prbvolpath` | all light, with media | `volpath` |
//! | `direct`, `direct_projective`, `direct_reparam` | light of one scattering event | `direct` |
//! | `emission_reparam` | lights that the camera sees | `path` without scattering |
//! | `aov`, `moment`, `stokes` | that of the integrator inside, with further channels | the integrator inside |
//! | `irrcache` | all light, indirect irradiance interpolated | `irradiance-cache`, as deep as the integrator inside |
//! | `depth` | distances | `path`, approximated |
//!
//! Paths of Mitsuba's differentiable integrators have 6 segments at most by default, but for `prbvolpath`; those of
//! others have no limit.

use super::{
    graph::{Category, ObjectId},
    reader::Reader,
    told::{NOISE, SPEED},
};
use steradian_scene::{Family, Node, NodeId};

/// The `max_depth` of an integrator that does not say it.
fn default_depth(plugin: &str) -> i64 {
    if plugin == "prb" || plugin.starts_with("prb_") { 6 } else { -1 }
}

impl Reader<'_> {
    /// The integrator, unwrapped from those that only add outputs to another.
    pub fn integrator(&mut self, object: ObjectId) -> Option<NodeId> {
        if !self.enter(object) {
            return None;
        }
        let node = self.integrator_node(object);
        self.leave();
        node
    }

    fn integrator_node(&mut self, object: ObjectId) -> Option<NodeId> {
        let plugin = self.plugin(object).to_owned();
        let kind = match plugin.as_str() {
            "aov" | "moment" | "stokes" | "multichannel" | "adaptive" => {
                let inner = self.wrapped(object);
                if let Some(inner) = inner {
                    self.note(
                        self.span(object),
                        format!("the outputs that '{plugin}' adds are asked for on the command line"),
                    );
                    return self.integrator(inner);
                }
                "path"
            }
            "direct" | "direct_projective" | "direct_reparam" => "direct",
            "path" | "emission_reparam" => "path",
            "volpath" | "volpathmis" | "volpath_simple" | "prbvolpath" => "volpath",
            "ao" => return Some(self.ambient_occlusion(object)),
            "depth" => {
                let what = "'depth' shows distances, which '--aov depth' writes as the layer 'depth.Z'; \
                     'path' renders the picture";
                self.approximated(self.span(object), what);
                "path"
            }
            "irrcache" => return self.irradiance_cache(object),
            "field" | "vpl" => {
                self.approximated(self.span(object), format!("there is no integrator '{plugin}'; 'path' is used"));
                "path"
            }
            "bdpt" => "bdpt",
            "mlt" | "pssmlt" => "pssmlt",
            "photonmapper" => "photon",
            "ppm" | "sppm" => "sppm",
            // Other estimators of the same picture.
            _ if self.is_known(object) => {
                let media = self.graph.objects.iter().any(|o| o.category == Category::Medium);
                let kind = if media { "volpath" } else { "path" };
                self.note(self.span(object), format!("'{kind}' estimates the picture of '{plugin}'"));
                kind
            }
            _ => {
                self.unknown_plugin(object);
                return None;
            }
        };
        let mut node = self.node(Family::Integrator, kind, object);
        if plugin == "emission_reparam" {
            node.set("max_depth", 0i64, None);
        } else if kind != "direct" {
            let depth = self.int(object, "max_depth").unwrap_or(default_depth(&plugin));
            let span = self.value_span(object, "max_depth");
            if depth < -1 {
                self.error(span, "'max_depth' is -1 for no limit, or the number of segments of a path");
            } else if depth == 0 {
                self.approximated(span, "a 'max_depth' of 0 is a black picture; emitters are shown");
            }
            // Mitsuba counts the segments of a path, Steradian the scattering events between them.
            let events = if depth < 0 { -1 } else { (depth - 1).max(0) };
            node.set("max_depth", events, Some(span));
            let rr_depth = self.int(object, "rr_depth").unwrap_or(5);
            node.set("rr_depth", rr_depth, Some(self.value_span(object, "rr_depth")));
        }
        let hide = self.bool(object, "hide_emitters").unwrap_or(false);
        node.set("hide_emitters", hide, Some(self.value_span(object, "hide_emitters")));
        self.means(object);
        let why = "light meets surfaces by their shading normals, wherever these point";
        self.left_out(object, "strict_normals", &["false"], why);
        match kind {
            "sppm" => {
                if let Some(n) = self.int(object, "photon_count").filter(|n| *n > 0) {
                    node.set("photons", n, None);
                }
                if let Some(r) = self.float(object, "initial_radius").filter(|r| *r > 0.0) {
                    node.set("radius", r, None);
                }
            }
            "pssmlt" => {
                if let Some(p) = self.float(object, "p_large").filter(|p| *p > 0.0 && *p <= 1.0) {
                    node.set("large_step", p, None);
                }
            }
            _ => {}
        }
        if kind != plugin {
            self.settings_of_another(object, kind);
        }
        Some(self.desc.add(node))
    }

    /// The integrator inside one that only adds outputs. As in Mitsuba, it has its own settings, and those around it
    /// that are not about outputs are none.
    fn wrapped(&mut self, object: ObjectId) -> Option<ObjectId> {
        let inner = self.graph.children(object, Category::Integrator);
        self.no_effect(object, &["aovs"], "'--aov' asks for layers");
        self.no_effect(object, &["meridian_align"], "Stokes vectors are not written");
        self.no_effect(object, &["max_error", "p_value", "max_sample_factor"], NOISE);
        if let Some(&(_, second)) = inner.get(1) {
            let what = "the picture of a second integrator is left out: the first renders the scene";
            self.dropped(self.span(second), what);
        }
        let &(_, first) = inner.first()?;
        self.means(object);
        self.no_effect(object, &["hide_emitters"], "the integrator inside has its own");
        Some(first)
    }

    /// Mitsuba 0.6's `irrcache`: its depth is that of the integrator inside, and its hemispheres have 2 resolution ×
    /// resolution cells. With the quality κ records reach 1/(2κ) of the least distance of what they see, within 1.5/κ
    /// and 10/κ pixels; the share of the mean distance, which is greater, is taken as 0.2/κ.
    fn irradiance_cache(&mut self, object: ObjectId) -> Option<NodeId> {
        let span = self.span(object);
        let mut node = self.node(Family::Integrator, "irradiance-cache", object);
        if let Some(inner) = self.wrapped(object) {
            let inner = self.integrator(inner)?;
            let inner = self.desc.node(inner).clone();
            if inner.kind != "path" {
                let what = format!("indirect light of the irradiance cache is that of 'path', not of '{}'", inner.kind);
                self.approximated(span, what);
            }
            for name in ["max_depth", "rr_depth"] {
                if let Some(depth) = inner.int(name) {
                    node.set(name, depth, Some(span));
                }
            }
            node.set("hide_emitters", inner.bool("hide_emitters").unwrap_or(false), Some(span));
        }
        let quality = self.float(object, "quality").unwrap_or(1.0);
        if quality > 0.0 {
            let at = Some(self.value_span(object, "quality"));
            node.set("error", (0.2 / quality).clamp(0.001, 1.0), at);
            for (name, pixels) in [("min_spacing", 1.5), ("max_spacing", 10.0)] {
                node.set(name, (pixels / quality).clamp(1e-3, 1e6), at);
            }
        }
        let resolution = self.int(object, "resolution").unwrap_or(14).clamp(1, 181);
        node.set("rays", 2 * resolution * resolution, Some(self.value_span(object, "resolution")));
        let gradients = self.bool(object, "gradients").unwrap_or(true);
        node.set("gradients", gradients, Some(self.value_span(object, "gradients")));
        self.no_effect(object, &["overture"], "records are made before the picture");
        self.left_out(object, "quality_adjustment", &["1"], "records count as far as they keep others from being made");
        self.left_out(object, "clamp_neighbor", &["true"], "neighbours always bound each other's reach");
        self.left_out(object, "clamp_screen", &["true"], "the reach of records is always bounded in pixels");
        self.left_out(object, "indirect_only", &["false"], "direct light is always shown");
        self.left_out(object, "debug", &["false"], "places of records are not shown");
        Some(self.desc.add(node))
    }

    /// Notes the settings that are about time, memory and noise alone.
    fn means(&mut self, object: ObjectId) {
        self.no_effect(object, &["block_size", "samples_per_pass"], SPEED);
        self.no_effect(object, &["timeout"], "'--time' ends a rendering early");
        let samples = ["emitter_samples", "bsdf_samples", "shading_samples", "use_spectral_mis"];
        self.no_effect(object, &samples, NOISE);
    }

    /// Mitsuba 0.6's `ao`: its rays have by default half the radius of the scene's bounding sphere, and where the camera
    /// sees nothing it is white.
    fn ambient_occlusion(&mut self, object: ObjectId) -> NodeId {
        let span = self.span(object);
        let mut node = self.node(Family::Integrator, "ao", object);
        self.means(object);
        if let Some(length) = self.float(object, "ray_length").filter(|length| *length > 0.0) {
            node.set("distance", length, Some(self.value_span(object, "ray_length")));
        } else {
            let what =
                "rays of ambient occlusion have no limit here; Mitsuba's default is half the radius of the scene";
            self.approximated(span, what);
        }
        self.approximated(span, "where the camera sees nothing, ambient occlusion is black here, and white in Mitsuba");
        self.desc.add(node)
    }

    /// Says which settings of another estimator of the same picture change nothing here.
    fn settings_of_another(&mut self, object: ObjectId, kind: &str) {
        let span = self.span(object);
        let unused = self.graph.objects[object].props.iter().filter(|p| !p.used);
        let unused: Vec<String> = unused.map(|p| self.graph.called(p)).collect();
        let object = &mut self.graph.objects[object];
        object.props.iter_mut().for_each(|p| p.used = true);
        if !unused.is_empty() {
            let message = format!("{} of '{}' has no effect on '{kind}'", unused.join(", "), object.plugin);
            self.note(span, message);
        }
    }

    /// Says so where Mitsuba's estimator takes surfaces that light passes straight for others than Steradian does.
    pub fn passed_surfaces(&mut self) {
        let Some(node) = self.desc.integrator.map(|i| self.desc.node(i)) else { return };
        if node.kind == "volpath" {
            return;
        }
        let passed = |o: &&super::graph::Object| {
            o.category == Category::Bsdf && o.visited && matches!(o.plugin.as_str(), "mask" | "null")
        };
        let Some((plugin, span)) = self.graph.objects.iter().find(passed).map(|o| (o.plugin.clone(), o.span)) else {
            return;
        };
        self.note(
            span,
            format!(
                "light passes '{plugin}' straight, as in Mitsuba's 'volpath'; its 'path' counts that towards 'max_depth', and lets no light of \
                 'point', 'spot' and 'directional' through"
            ),
        );
    }

    /// Mitsuba renders scenes without an integrator with `path`; media are rendered here.
    pub fn default_integrator(&mut self) {
        if self.desc.integrator.is_none() {
            let media = self.graph.objects.iter().any(|o| o.category == Category::Medium);
            let kind = if media { "volpath" } else { "path" };
            let node = Node::new(Family::Integrator, kind, None).with("max_depth", -1i64).with("rr_depth", 5i64);
            self.desc.integrator = Some(self.desc.add(node));
        }
    }
}
