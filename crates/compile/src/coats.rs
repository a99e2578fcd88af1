//! The tables of coats and of diffusion below surfaces, shared by materials: one takes milliseconds to make, and scenes
//! have many materials.

use crate::subsurface::ProfileKey;
use std::{collections::HashMap, sync::Arc};
use steradian_bsdf::{
    CoatSeries, CoatTable, EnergyTable, NormalDistribution, Shadowing,
    subsurface::{ProfileTable, WalkAlbedo},
};
use steradian_math::spectra::ColorMode;

/// Roughnesses of one kind of coat that get a table of their own; further ones share a table over all roughnesses.
const EXACT: usize = 16;

/// Key of a kind of coat, apart from its roughness, by bits.
type Kind = (NormalDistribution, Shadowing, u32, [u32; 3]);

/// Coats that differ in roughness alone.
#[derive(Debug, Default)]
struct Tables {
    /// By the bits of the roughness.
    exact: HashMap<[u32; 2], Arc<CoatTable>>,
    ranged: Option<Arc<CoatTable>>,
}

/// All tables made so far.
#[derive(Debug, Default)]
pub(super) struct Coats {
    coats: HashMap<Kind, Tables>,
    energies: HashMap<(NormalDistribution, Shadowing), Arc<EnergyTable>>,
    /// Profiles of diffusion.
    pub profiles: HashMap<ProfileKey, Arc<ProfileTable>>,
    /// Albedos of random walks, by the bits of index and mean cosine.
    pub walks: HashMap<(u32, u32), Arc<WalkAlbedo>>,
    /// True if RGB lanes stand for spectra over which the layers of pbrt's materials are summed: its materials are
    /// spectral by definition. Mitsuba's plastics in RGB are defined by RGB arithmetic.
    over_rgb_spectra: bool,
}

impl Coats {
    /// No tables yet.
    pub fn new(mode: ColorMode) -> Self {
        Self { over_rgb_spectra: mode == ColorMode::Rgb, ..Self::default() }
    }

    /// The table of a coat, by the arguments of [`CoatTable::new`].
    pub fn table(
        &mut self,
        distribution: NormalDistribution,
        shadowing: Shadowing,
        eta: f32,
        alpha: (f32, f32),
        series: CoatSeries,
    ) -> Arc<CoatTable> {
        let series_bits = match series {
            CoatSeries::Layered { thickness, max_depth } => [0, thickness.to_bits(), max_depth],
            CoatSeries::Plastic { nonlinear } => [1, u32::from(nonlinear), 0],
        };
        let over_rgb_spectra = self.over_rgb_spectra && matches!(series, CoatSeries::Layered { .. });
        let make = |alpha| {
            let table = CoatTable::new(distribution, shadowing, eta, alpha, series);
            Arc::new(if over_rgb_spectra { table.over_rgb_spectra() } else { table })
        };
        let tables = self.coats.entry((distribution, shadowing, eta.to_bits(), series_bits)).or_default();
        let key = [alpha.0.to_bits(), alpha.1.to_bits()];
        if tables.exact.len() >= EXACT && !tables.exact.contains_key(&key) {
            return tables.ranged.get_or_insert_with(|| make((0.0, 1.0))).clone();
        }
        tables.exact.entry(key).or_insert_with(|| make(alpha)).clone()
    }

    /// Energy loss of microfacets of a kind.
    pub fn energy(&mut self, distribution: NormalDistribution, shadowing: Shadowing) -> Arc<EnergyTable> {
        let make = || Arc::new(EnergyTable::new(distribution, shadowing));
        self.energies.entry((distribution, shadowing)).or_insert_with(make).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_coats_share_a_table_and_many_roughnesses_share_one() {
        let mut coats = Coats::default();
        let series = CoatSeries::Plastic { nonlinear: false };
        let mut table =
            |alpha: f32| coats.table(NormalDistribution::Ggx, Shadowing::Separable, 1.5, (alpha, alpha), series);
        let first = table(0.0);
        assert!(Arc::ptr_eq(&first, &table(0.0)));
        let many: Vec<_> = (1..40).map(|i| table(i as f32 / 40.0)).collect();
        assert!(Arc::ptr_eq(&many[20], &many[30]) && !Arc::ptr_eq(&many[1], &many[2]));
        assert!(Arc::ptr_eq(&first, &table(0.0)));
    }
}
