//! Spectrum plugins: `<spectrum type="…">`.

use super::{
    graph::{Category, ObjectId, Prop, Raw},
    reader::Reader,
    texture::{Role, flat, rgb},
    values,
};
use steradian_scene::{SpectrumValue, Value};

impl Reader<'_> {
    /// The spectrum that a spectrum plugin stands for.
    pub fn spectrum_plugin(&mut self, object: ObjectId, role: Role) -> Option<Value> {
        match self.plugin(object) {
            "uniform" | "rawconstant" => {
                if self.plugin(object) == "uniform" {
                    let why = "a uniform spectrum has no ends";
                    self.left_out(object, "wavelength_min", &["360"], why);
                    self.left_out(object, "wavelength_max", &["830"], why);
                }
                match self.graph.take(object, "value")?.value {
                    Raw::Rgb(c) | Raw::Vec3(c) => Some(rgb(c)),
                    _ => self.float(object, "value").map(|v| flat(v, role)),
                }
            }
            "srgb" => match self.graph.take(object, "color")?.value {
                Raw::Rgb(c) => Some(rgb(c)),
                _ => {
                    self.error(self.value_span(object, "color"), "'color' needs an <rgb> value");
                    None
                }
            },
            "d65" => self.d65(object),
            "blackbody" => {
                let temperature = self.float(object, "temperature");
                let range = [self.float(object, "wavelength_min"), self.float(object, "wavelength_max")];
                let range = [range[0].unwrap_or(360.0), range[1].unwrap_or(830.0)];
                let spectrum = values::blackbody(temperature.unwrap_or(0.0), range, 1.0);
                self.spectrum_or_error(object, spectrum)
            }
            _ => {
                let spectrum = self.tabulated(object);
                self.spectrum_or_error(object, spectrum)
            }
        }
    }

    fn spectrum_or_error(&mut self, object: ObjectId, spectrum: Result<SpectrumValue, String>) -> Option<Value> {
        spectrum.map(Value::Spectrum).map_err(|e| self.error(self.span(object), e)).ok()
    }

    /// `regular` (values over a range) and `irregular` (values at wavelengths).
    fn tabulated(&mut self, object: ObjectId) -> Result<SpectrumValue, String> {
        let spectrum = |p: &Prop| p.name == "value" && matches!(p.value, Raw::Spectrum(_));
        if self.graph.objects[object].props.iter().any(spectrum)
            && let Some(Raw::Spectrum(s)) = self.graph.take(object, "value").map(|p| p.value)
        {
            return Ok(s);
        }
        let listed = self.string(object, "values").ok_or("a tabulated spectrum needs 'values'")?;
        let listed = values::numbers(&listed)?;
        let lambdas = if self.plugin(object) == "regular" {
            let range = ["lambda_min", "lambda_max", "wavelength_min", "wavelength_max"].map(|n| self.float(object, n));
            let (low, high) = (range[0].or(range[2]), range[1].or(range[3]));
            let (low, high) = low.zip(high).ok_or("a regular spectrum needs 'wavelength_min' and 'wavelength_max'")?;
            let step = (high - low) / listed.len().saturating_sub(1).max(1) as f64;
            (0..listed.len()).map(|i| low + step * i as f64).collect()
        } else {
            values::numbers(&self.string(object, "wavelengths").ok_or("an irregular spectrum needs 'wavelengths'")?)?
        };
        if lambdas.len() != listed.len() {
            return Err(format!("{} wavelengths, but {} values", lambdas.len(), listed.len()));
        }
        values::sampled(&lambdas.into_iter().zip(listed).collect::<Vec<_>>())
    }

    /// D65 times a colour, a texture or nothing. Emission already means multiples of D65.
    fn d65(&mut self, object: ObjectId) -> Option<Value> {
        let scale = self.float(object, "scale").unwrap_or(1.0);
        if let Some((_, inner)) = self.graph.children(object, Category::Texture).into_iter().next() {
            let inner = self.texture(inner, Role::Emission)?;
            return if scale == 1.0 { Some(inner) } else { Some(Value::Node(self.scaled(object, inner, scale))) };
        }
        match self.graph.take(object, "color").map(|p| p.value) {
            Some(Raw::Rgb(c)) => Some(rgb(c.map(|v| v * scale))),
            Some(_) => {
                self.error(self.value_span(object, "color"), "'color' needs an <rgb> value");
                None
            }
            None => Some(rgb([scale; 3])),
        }
    }
}
