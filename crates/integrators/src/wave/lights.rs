//! Light samples of a block's vertices: the choice of lights, in columns down the light tree, and points on these.

use super::block::{self, Block};
use steradian_accel::{
    Lanes,
    columns::{Column, WIDTH, get3, set3, set4},
};
use steradian_core::{
    Scene,
    light::{Choice, Light, LightContext},
};
use steradian_engine::{PixelSample, dimension};
use steradian_math::Vec2;

/// Chooses lights, where light matters: fills `lights` with them, and the column of densities with the probabilities,
/// zero where there is none.
fn choose(
    lanes: Lanes,
    b: &mut Block,
    numbers: impl Iterator<Item = u32>,
    scene: &Scene,
    pixel_samples: &[PixelSample],
    lights: &mut Column<u32>,
) {
    let (all, nodes) = (scene.lights(), scene.lights().tree().nodes());
    // One light in all, which has bounds: no choice.
    if !all.are_many()
        && let [node] = nodes
    {
        lights.fill(node.index);
        b.light_pdf = b.takes_light.map(|takes| if takes == 0 { 0.0 } else { 1.0 });
        return;
    }
    // Those on their way down the tree, with the node where they are, and the probability of the tree.
    let (mut going, mut count) = ([(0, 0, 0.0); WIDTH], 0);
    for (k, number) in numbers.enumerate() {
        b.light_pdf[k] = 0.0;
        if b.takes_light[k] == 0 || !all.can_sample() {
            continue;
        }
        // An infinite light, or the light tree: those that go down the tree are put on a list.
        let ctx = LightContext { p: get3(&b.p, k), n: get3(&b.light_n, k) };
        let own = &pixel_samples[number as usize].own;
        let u = own.get_1d_lazily(dimension::at(b.events[k], dimension::LIGHT), all.are_many());
        match all.choose_kind(&ctx, u) {
            Some(Choice::Infinite(light, p)) => (lights[k], b.light_pdf[k]) = (light, p),
            Some(Choice::Tree(u, share)) => {
                (b.choice[k], b.chance[k]) = (u, 1.0);
                going[count] = (k, 0, share);
                count += 1;
            }
            None => {}
        }
    }
    // Level by level, all vertices on the list take a step down the tree together.
    loop {
        let mut on_their_way = 0;
        for at in 0..count {
            let (k, place, share) = going[at];
            let Some(node) = nodes.get(place) else { continue };
            // At a leaf: the light, with probability P(tree) ∏ P(child).
            if node.leaf {
                (lights[k], b.light_pdf[k]) = (node.index, b.chance[k] * share);
            } else {
                // Else both children go to the columns: the first follows its parent, the second has an index.
                b.children[0].set(k, &nodes[place + 1].cluster);
                b.children[1].set(k, &nodes[node.index as usize].cluster);
                going[on_their_way] = (k, place, share);
                on_their_way += 1;
            }
        }
        count = on_their_way;
        if count == 0 {
            return;
        }
        block::children(lanes, b);
        on_their_way = 0;
        for at in 0..count {
            let (k, place, share) = going[at];
            // Where neither child can contribute, there is no light sample.
            if b.chance[k] > 0.0 {
                let next = if b.is_second[k] != 0 { nodes[place].index as usize } else { place + 1 };
                going[on_their_way] = (k, next, share);
                on_their_way += 1;
            }
        }
        count = on_their_way;
    }
}

/// Fills the columns of light samples, where light matters.
pub fn illuminate(
    lanes: Lanes,
    b: &mut Block,
    numbers: impl Iterator<Item = u32> + Clone,
    scene: &Scene,
    pixel_samples: &[PixelSample],
) {
    let (all, mut lights) = (scene.lights(), [0; WIDTH]);
    let (mut has_flat, mut has_large) = (false, false);
    // A light for each vertex, then a point on it: flat area lights of even radiance by kernel, all others one by one.
    choose(lanes, b, numbers.clone(), scene, pixel_samples, &mut lights);
    for (k, number) in numbers.enumerate() {
        b.is_flat[k] = 0;
        let (p, light, lambda) = (b.light_pdf[k], lights[k], &pixel_samples[number as usize].lambda);
        if p <= 0.0 {
            continue;
        }
        let at = get3(&b.p, k);
        if let Light::Area(area) = &all.lights[light as usize] {
            let emitter = &all.emitters[area.emitter as usize];
            if let (Some(flat), Some(radiance)) = (area.flat(at), emitter.everywhere(lambda)) {
                // Geometry of the light, unless the lane still has it from the block before.
                if b.flat_number[k] != light {
                    b.flat_number[k] = light;
                    set3(&mut b.flat_corner, k, flat.corner);
                    set3(&mut b.flat_edges[0], k, flat.edges[0]);
                    set3(&mut b.flat_edges[1], k, flat.edges[1]);
                    set3(&mut b.flat_n, k, flat.n);
                    b.flat_area[k] = flat.area;
                    b.flat_is_triangle[k] = flat.is_triangle.into();
                    b.flat_is_two_sided[k] = emitter.two_sided.into();
                }
                set4(&mut b.light_radiance, k, radiance.to_array());
                (b.light_is_delta[k], b.is_flat[k], has_flat) = (0, 1, true);
                b.light_pdf[k] = if radiance.is_black() { 0.0 } else { p };
                has_large |= flat.is_large(at);
                continue;
            }
        }
        b.light_pdf[k] = 0.0;
        let ctx = LightContext { p: at, n: get3(&b.light_n, k) };
        let u = Vec2::new(b.light_u[0][k], b.light_u[1][k]);
        // Any other light: direction, distance, radiance, and density times the probability of the choice.
        let Some(s) = all.sample(light, &ctx, u, lambda, scene.textures()) else { continue };
        set3(&mut b.light_wi, k, s.wi);
        set4(&mut b.light_radiance, k, s.radiance.to_array());
        (b.light_distance[k], b.light_pdf[k]) = (s.distance, s.pdf * p);
        b.light_is_delta[k] = s.is_delta.into();
    }
    // The kernel for large lights also samples their solid angle; small lights do without it.
    match (has_flat, has_large) {
        (_, true) => block::flat_lights(lanes, b),
        (true, false) => block::small_lights(lanes, b),
        (false, false) => {}
    }
}
