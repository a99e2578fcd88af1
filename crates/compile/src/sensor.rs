//! The sensor of a film: what adds noise to the picture.

use super::Compiler;
use steradian_image::Sensor;
use steradian_scene::Node;

const NAMES: [&str; 5] = ["full_well", "read_noise", "dark_current", "bits", "noise_seed"];

impl Compiler<'_> {
    /// The sensor, where the film names a full well.
    pub(super) fn sensor(&mut self, film: &Node) -> Option<Sensor> {
        // The other parameters are checked elsewhere.
        let mut node = film.clone();
        node.params.retain(|p| NAMES.contains(&p.name.as_str()));
        let node = &*self.within_ranges(&node);
        let idle = NAMES[1..].iter().find_map(|name| node.param(name));
        if let Some(p) = idle.filter(|_| film.get("full_well").is_none()) {
            let what = format!("parameter '{}' of the film has no effect without 'full_well'", p.name);
            self.diagnostics.unused(&self.desc.sources, p.span.or(film.span), what, None);
        }
        let default = Sensor::default();
        let sensor = Sensor {
            full_well: f64::from(self.float(node, "full_well", 0.0)),
            read_noise: f64::from(self.float(node, "read_noise", 0.0)),
            dark_current: f64::from(self.float(node, "dark_current", 0.0)),
            bits: self.int(node, "bits").map_or(default.bits, |bits| bits.clamp(1, 24) as u32),
            iso: film.float("iso").filter(|v| *v > 0.0).unwrap_or(default.iso),
            exposure_time: film.float("exposure_time").filter(|v| *v > 0.0).unwrap_or(default.exposure_time),
            seed: self.int(node, "noise_seed").unwrap_or(0) as u64,
            ..default
        };
        (sensor.full_well > 0.0).then_some(sensor)
    }
}
