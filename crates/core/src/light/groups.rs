//! Groups of lights: pictures can show the light of each by itself.

use super::{Light, Lights};
use std::collections::BTreeMap;

/// Assignment of lights to groups. Lights and emitting shapes of the same name are one group; those without a name are
/// one for each light that the file describes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightGroups {
    /// Names, by number.
    pub names: Vec<String>,
    /// The group of each of [`Lights::lights`].
    pub of_lights: Vec<u32>,
    /// The group of each of [`Lights::emitters`].
    pub of_emitters: Vec<u32>,
    /// The numbers of the names.
    numbers: BTreeMap<String, u32>,
}

impl LightGroups {
    /// The number of a name, which is added where it is new.
    pub fn number(&mut self, name: &str) -> u32 {
        // A scene may have a million lights.
        if let Some(known) = self.numbers.get(name) {
            return *known;
        }
        let number = self.names.len() as u32;
        self.names.push(name.into());
        self.numbers.insert(name.into(), number);
        number
    }

    /// Notes the groups of all lights, those of areas by their emitters; `others` has the light and group of each other
    /// one.
    pub fn assign(&mut self, lights: &Lights, others: &[(u32, u32)]) {
        // Emitting areas inherit the group of their emitter; other lights are listed one by one.
        self.of_lights = lights
            .lights
            .iter()
            .map(|light| match light {
                Light::Area(a) | Light::DirectionalArea(a) => self.of_emitters[a.emitter as usize],
                _ => 0,
            })
            .collect();
        for &(light, group) in others {
            self.of_lights[light as usize] = group;
        }
    }
}
