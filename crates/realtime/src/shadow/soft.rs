//! Soft shadows of area lights by maps (Fernando 2005, "Percentage-Closer Soft Shadows").
//!
//! The mean distance of what lies before a point tells where the light's outline falls on the map; the share of lit
//! texels in it is the share of the light that is seen. It would be exact if all that blocks were one plane at that
//! distance, seen from the middle of the light.

use steradian_core::{Scene, light::AreaShape};
use steradian_math::{Vec2, Vec3};

use super::{
    FACES, cube_views, face,
    map::{Filter, Map, STEEPEST},
};
use crate::{Error, draw_list::DrawList, options::Options};

/// Points of the light that blockers are looked for towards, and that are asked for.
const SEARCHED: u32 = 16;
const ASKED: u32 = 48;

/// Maps from the middle of a light.
#[derive(Debug)]
pub struct Soft {
    center: Vec3,
    outline: Outline,
    maps: Vec<Map>,
    /// The distance of the nearest blocker.
    least: f32,
}

/// Outline of the light as seen from afar.
#[derive(Clone, Copy, Debug)]
enum Outline {
    /// Two edges from a corner.
    Parallelogram([Vec3; 3]),
    Triangle([Vec3; 3]),
    /// A radius.
    Sphere(f32),
}

impl Outline {
    /// A point of the light, relative to its middle, as seen along `direction`.
    fn point(&self, index: u32, center: Vec3, direction: Vec3) -> Vec3 {
        // Spread points over the outline by a low-discrepancy sequence.
        let u = crate::spread(index);
        match *self {
            Self::Parallelogram([corner, ex, ey]) => corner + ex * u.x + ey * u.y - center,
            Self::Triangle([a, b, c]) => {
                // Folds the unit square onto the triangle.
                let u = if u.x + u.y > 1.0 { Vec2::ONE - u } else { u };
                a + (b - a) * u.x + (c - a) * u.y - center
            }
            // A uniform point of the disk across the direction: its radius is √u.
            Self::Sphere(radius) => {
                let (right, up) = direction.any_orthonormal_pair();
                let (sin, cos) = (std::f32::consts::TAU * u.y).sin_cos();
                (right * cos + up * sin) * (radius * u.x.sqrt())
            }
        }
    }
}

impl Soft {
    /// Draws the maps of a light; `None` for shapes without a simple outline.
    pub fn new(scene: &Scene, list: &DrawList, shape: &AreaShape, options: &Options) -> Result<Option<Self>, Error> {
        let (place, outline, inner) = match shape {
            AreaShape::Triangle(corners, ..) => {
                ((corners[0] + corners[1] + corners[2]) / 3.0, Outline::Triangle(*corners), 0.0)
            }
            AreaShape::Rectangle { corner, ex, ey, .. } => {
                (*corner + (*ex + *ey) / 2.0, Outline::Parallelogram([*corner, *ex, *ey]), 0.0)
            }
            AreaShape::Sphere(center, radius, false) => (*center, Outline::Sphere(*radius), *radius),
            AreaShape::Sphere(..) | AreaShape::Quadric(_) | AreaShape::Swept(_) | AreaShape::Moving(_) => {
                return Ok(None);
            }
        };
        let (center, radius) = crate::extent(scene);
        let reach = (place - center).length() + radius;
        // A flat light is seen edge on from its middle, so it hides nothing; a sphere's own surface is left out by the
        // start of the views.
        let near = (1.001 * inner).max(1e-4 * reach);
        let views = cube_views(place, [near, reach], options.size);
        let maps = views.into_iter().map(|view| Map::new(scene, list, view, options.size));
        let maps: Vec<Map> = maps.collect::<Result<_, _>>()?;
        let least = maps.iter().flat_map(|map| &map.distances).fold(f32::INFINITY, |a, b| a.min(*b));
        Ok(Some(Self { center: place, outline, maps, least }))
    }

    /// Shadow maps of the directions +x, −x, +y, −y, +z, −z.
    pub fn maps(&self) -> &[Map] {
        &self.maps
    }

    /// The share of the light that a point sees.
    pub fn lit(&self, p: Vec3, n: Vec3, filter: &Filter) -> f32 {
        // Nearer than any blocker the point sees the whole light.
        let d = p - self.center;
        let distance = d.length();
        let direction = d / distance;
        if !(self.least < distance && direction.is_finite()) {
            return 1.0;
        }
        let cos = n.dot(direction).abs();
        let slope = ((1.0 - cos * cos).max(0.0).sqrt() / cos.max(1e-6)).min(STEEPEST);
        let allowed = filter.bias * 2.0 / self.maps[0].size as f32 * (0.1 + 0.02 * slope);
        // Towards a point of the light, where its ray is this share of the way from the light to the point.
        let towards =
            |index: u32, share: f32| self.outline.point(index, self.center, direction) * (1.0 - share) + d * share;
        // How far what is seen in a direction is along the middle ray, if it lies before the plane of the surface.
        let blocker = |t: Vec3| {
            let (axis, seen) = self.look(t)?;
            // Both in units of the direction through the texel's centre.
            let plane = n.dot(d) / n.dot(axis);
            // Where the surface is seen so obliquely that its plane says nothing, it is taken to face the light.
            let facing = distance / axis.dot(direction);
            let plane = if plane > 0.0 && plane < 2.0 * facing { plane } else { facing };
            (seen < plane * (1.0 - allowed)).then(|| seen * axis.dot(direction))
        };
        // Step 1, blocker search: the mean distance of what lies before the point.
        let (mut sum, mut count) = (0.0, 0.0);
        for index in 0..SEARCHED {
            if let Some(found) = blocker(towards(index, self.least / distance)) {
                sum += found;
                count += 1.0;
            }
        }
        // The search is as wide as the nearest blocker of all may ask for; small blockers near the point are found
        // along the middle.
        if let Some(found) = blocker(d) {
            sum += found;
            count += 1.0;
        }
        if count == 0.0 {
            return 1.0;
        }
        // Step 2, penumbra estimate: the light's outline projected through the point onto the plane of the mean
        // blocker.
        let share = (sum / count / distance).clamp(1e-3, 1.0);
        // Step 3, filter: the share of directions through that outline without a blocker.
        let lit = (0..ASKED).filter(|&index| blocker(towards(index, share)).is_none()).count();
        lit as f32 / ASKED as f32
    }

    /// The direction through the centre of the texel that looks this way, and in units of it the distance of what it
    /// sees.
    fn look(&self, t: Vec3) -> Option<(Vec3, f32)> {
        let number = face(6, -t);
        let (map, [right, up, forward]) = (&self.maps[number], FACES[number]);
        let local = Vec3::new(t.dot(right), t.dot(up), t.dot(forward));
        let at = |x: f32| (((x / local.z) * 0.5 + 0.5) * map.size as f32).clamp(0.0, (map.size - 1) as f32) as u32;
        let (column, row) = (at(local.x), at(-local.y));
        let seen = map.distances[(row * map.size + column) as usize];
        let texel = map.direction(column, row);
        (local.z > 0.0 && seen.is_finite()).then(|| (right * texel.x + up * texel.y + forward, seen))
    }
}
