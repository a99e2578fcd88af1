//! The sensor of a film: how it sees colours, and what adds noise to the picture.

use super::{Compiler, SensorNoise};
use std::sync::Arc;
use steradian_image::Sensor;
use steradian_math::spectra::{ColorMode, Response};
use steradian_scene::{Node, names};

const NAMES: [&str; 5] = ["full_well", "read_noise", "dark_current", "bits", "noise_seed"];

/// The sensor that is the CIE 1931 observer.
const OBSERVER: &str = "cie1931";

impl Compiler<'_> {
    /// Spectral response of the film, where that is not the observer's without a white balance.
    pub(super) fn response(&mut self, film: &Node) -> Option<Arc<Response>> {
        let name = self.word(film, "sensor");
        let balance = self.float(film, "white_balance");
        let at = |name: &str| film.param(name).and_then(|p| p.span).or(film.span);
        let is_camera = name != OBSERVER;
        if is_camera && !Response::cameras().any(|(known, _)| known == name) {
            let help = names::did_you_mean(name, Response::cameras().map(|(name, _)| name).chain([OBSERVER]));
            self.error_help(at("sensor"), format!("unknown sensor '{name}'"), help);
            return None;
        }
        if !is_camera && balance == 0.0 {
            return None;
        }
        // pbrt balances cameras for 6500 K where nothing else is said.
        let kelvin = if balance == 0.0 { 6500.0 } else { f64::from(balance) };
        let is_seen = is_camera && self.mode == ColorMode::Spectral;
        if is_camera && !is_seen {
            let what = format!("the sensor '{name}' needs spectra (--color spectral); the CIE 1931 observer stands in");
            self.approximated(at("sensor"), what);
        }
        let response = match is_seen {
            true => Response::camera(name, kelvin),
            false => Response::observer(kelvin).map(Some),
        };
        match response {
            Ok(response) => response.map(Arc::new),
            Err(_) => {
                let what = format!(
                    "a white balance for {kelvin} K is not known: it is above 0 and at most 25000 K, 0 for none"
                );
                self.error(at("white_balance"), what);
                None
            }
        }
    }

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
        let SensorNoise::OfFrame(frame) = self.options.sensor_noise else { return None };
        let default = Sensor::default();
        let sensor = Sensor {
            full_well: f64::from(self.float_or(node, "full_well", 0.0)),
            read_noise: f64::from(self.float(node, "read_noise")),
            dark_current: f64::from(self.float(node, "dark_current")),
            bits: self.int(node, "bits").clamp(1, 24) as u32,
            iso: film.float("iso").filter(|v| *v > 0.0).unwrap_or(default.iso),
            exposure_time: film.float("exposure_time").filter(|v| *v > 0.0).unwrap_or(default.exposure_time),
            seed: self.int(node, "noise_seed") as u64,
            frame,
        };
        (sensor.full_well > 0.0).then_some(sensor)
    }
}
