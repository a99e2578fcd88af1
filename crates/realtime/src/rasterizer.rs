//! Pictures by the graphics pipeline, pass by pass: each is one sample of every pixel, at one place of all of them.

use crate::{
    Error,
    clusters::Clusters,
    culling::{Chunks, Culling, Selection, Tally, Verdict, classify, judge},
    draw_list::DrawList,
    image_light::ImageLights,
    lesson,
    options::{EnvironmentKind, LightChoice, Method, Options, Show},
    preparation::Preparation,
    projection::Projected,
    shading::Shader,
    shadow::{Eye, Shadowing},
    spread,
    trace::Trace,
    transparency::{Layers, View},
    triangle_light::{Found, TriangleLight, key, view_of},
    visibility::{Cover, Seen, Visibility, Wanted},
};
use std::sync::OnceLock;
use steradian_core::{
    Scene,
    film::{FilmSpec, LayerInputs, PassFilm},
    scene::Shape,
};
use steradian_engine::{Counters, Pass, Plan, Run, Sight, first_hit, shadow_catcher};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};
use steradian_transport::Depth;

/// A render by the pipeline.
#[derive(Debug)]
pub struct Rasterizer {
    options: Options,
    depth: Depth,
    transparent: bool,
    /// Enables a separate picture for each group of lights.
    by_light: bool,
    preparation: Preparation,
    /// Made once, for kinds of shadows that hold for all passes.
    shadows: OnceLock<Shadowing>,
    /// Lights by cells of the view of the first pass, where the options ask for that.
    clusters: OnceLock<Clusters>,
    /// Environments by their coefficients, where the options ask for that.
    image_lights: OnceLock<ImageLights>,
    /// Pixels that the painter's algorithm gets wrong in the first pass.
    wrong: OnceLock<usize>,
    /// Chunks that are culled; made by the first pass that needs them, alike in all.
    chunks: OnceLock<Chunks>,
    /// Notes of the culling of the first pass, and of the class of method that it shows.
    culled: OnceLock<String>,
    classified: OnceLock<String>,
}

/// LayerInputs of a pass.
struct Drawing<'a> {
    run: &'a Run<'a>,
    list: &'a DrawList,
    number: u32,
    projected: Projected,
    /// Weight of its samples by the pixel filter.
    weight: f32,
    /// Chunks and their verdicts, where culling is by chunks or they are shown.
    culled: Option<(&'a Chunks, Vec<Verdict>)>,
    visibility: Visibility,
    /// Transparent layers before what `visibility` shows, where they are blended.
    layers: Option<Layers>,
}

impl Rasterizer {
    /// Draws a scene as the options say: with one pass at the centres of pixels, with more spread by the pixel filter,
    /// so that pictures converge to those of rays. `depth` has the most scattering events, and whether the camera sees
    /// lights.
    ///
    /// # Errors
    /// Cameras that have no projection to a plane, frames that the pipeline refuses, and views that need what the scene
    /// does not have.
    pub fn new(scene: &Scene, options: Options, depth: Depth, plan: &Plan) -> Result<Self, Error> {
        // Refuse cameras without a planar projection before any pass runs.
        Projected::new(scene, Vec2::splat(0.5))?;
        lesson::check(scene, &options)?;
        Ok(Self {
            options,
            depth,
            transparent: plan.transparent,
            by_light: plan.has(LayerInputs::LIGHT_GROUPS),
            preparation: Preparation::default(),
            shadows: OnceLock::new(),
            clusters: OnceLock::new(),
            image_lights: OnceLock::new(),
            wrong: OnceLock::new(),
            chunks: OnceLock::new(),
            culled: OnceLock::new(),
            classified: OnceLock::new(),
        })
    }

    fn draw(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Result<Option<Counters>, Error> {
        let Some((list, pool)) = self.preparation.get() else { return Ok(None) };
        let drawing = pool.install(|| self.drawing(run, list, number))?;
        if self.options.lights == LightChoice::Clustered && self.clusters.get().is_none() {
            // Cells lie about the centres of pixels, whichever pass comes first.
            let view = Projected::new(run.scene, Vec2::splat(0.5))?;
            let _ = self.clusters.set(pool.install(|| Clusters::new(run.scene, &view))?);
        }
        // The painter's algorithm has no right order for all scenes: its errors are counted against the depth buffer.
        if number == 0 && self.options.visibility == Method::Painter {
            let right = pool.install(|| Visibility::draw(run.scene, list, &drawing.projected))?;
            let _ = self.wrong.set(drawing.visibility.differing(&right));
        }
        if run.is_cancelled() {
            return Ok(None);
        }
        let of_pass;
        // Shadow data of pixels (volumes, planes) belong to one subpixel position; maps serve all passes.
        let shadows = if self.options.shadows.is_of_pixels() {
            of_pass = pool.install(|| self.shadowing(&drawing))?;
            &of_pass
        } else {
            self.shadows_of_all(&drawing, pool)?
        };
        if run.is_cancelled() {
            return Ok(None);
        }
        // Views that explain the pipeline are drawn whole, once for the pass; all others pixel by pixel.
        let eye = drawing.eye();
        let lesson = match self.options.show {
            Show::Culling => pool.install(|| self.classified(&drawing))?,
            _ => pool.install(|| lesson::picture(run.scene, list, &eye, &self.options, shadows))?,
        };
        // Flat and Gouraud shading compute light at the corners first, for the pixels to interpolate.
        let Some((triangles, of_corners)) = self.triangle_light(&drawing, shadows) else { return Ok(None) };
        let crop = run.scene.film().crop;
        let (width, height) = (crop.width() as usize, crop.height() as usize);
        // Rows in parallel; their counters are added in the order of rows.
        let rows = run.in_order(height, |row, counters| {
            let pixel = |column: usize| match &lesson {
                Some(lesson) => Found::of(lesson[row * width + column]),
                None => self.pixel(&drawing, (shadows, &triangles), [column as u32, row as u32], counters),
            };
            (0..width).take_while(|_| !run.is_cancelled()).map(pixel).collect::<Vec<_>>()
        });
        let Some((rows, mut counters)) = rows else { return Ok(None) };
        // Splat the samples of the pass, those of each light group beside them.
        for (at, found) in rows.iter().flatten().enumerate() {
            film.add(crop.x0 + (at % width) as u32, crop.y0 + (at / width) as u32, found.value);
            film.add_lights(at, &found.lights);
        }
        counters += &of_corners;
        counters.samples = (width * height) as u64;
        Ok(Some(counters))
    }

    /// LayerInputs of a pass, with the visibility from its subpixel position.
    fn drawing<'a>(&'a self, run: &'a Run<'a>, list: &'a DrawList, number: u32) -> Result<Drawing<'a>, Error> {
        let (offset, weight) = place(run.scene.film(), number);
        // One sample alone is the whole pixel.
        let weight = if run.sampler.spp > 1 { weight } else { 1.0 };
        let projected = Projected::new(run.scene, offset)?.hiding_emitters(self.depth.hide_emitters);
        let culled = self.culled(run, list, &projected)?;
        if let (0, Some((chunks, verdicts))) = (number, &culled) {
            let _ = self.culled.set(Tally::new(self.options.culling, chunks, verdicts).to_string());
        }
        let selection = match (&culled, self.options.culling) {
            (Some((chunks, verdicts)), _) => Selection::Chunks(chunks, verdicts),
            (None, Culling::None) => Selection::All,
            (None, _) => Selection::Items,
        };
        // Where layers are blended the visibility buffer shows what is opaque.
        let (method, blends) = (Some(self.options.visibility), self.options.blends() && run.scene.has_layers());
        let cover = if blends { Cover::Opaque } else { Cover::Tested };
        let visibility = Visibility::draw_wanted(run.scene, list, &projected, Wanted { selection, method, cover })?;
        let layers = || {
            let view = View { scene: run.scene, list, projected: &projected, selection, opaque: &visibility };
            Layers::new(&view, self.options.transparency, self.options.layers)
        };
        let layers = blends.then(layers).transpose()?;
        Ok(Drawing { run, list, number, projected, weight, culled, visibility, layers })
    }

    /// Chunks and their verdicts, where culling is by chunks or they are shown.
    fn culled(
        &self,
        run: &Run<'_>,
        list: &DrawList,
        projected: &Projected,
    ) -> Result<Option<(&Chunks, Vec<Verdict>)>, Error> {
        let Options { culling, bounds, show, .. } = self.options;
        if !culling.is_by_chunks() && show != Show::Culling {
            return Ok(None);
        }
        // Passes may come here at once; all make the same chunks, and the first ones are kept.
        if self.chunks.get().is_none() {
            let _ = self.chunks.set(Chunks::new(run.scene, list, projected, bounds));
        }
        let Some(chunks) = self.chunks.get() else { return Ok(None) };
        Ok(Some((chunks, judge(run.scene, list, projected, chunks, culling)?)))
    }

    /// Colours of pixels by verdicts against the truth.
    fn classified(&self, drawing: &Drawing<'_>) -> Result<Option<Vec<Vec3>>, Error> {
        let Drawing { run, list, number, projected, culled: Some((chunks, verdicts)), .. } = drawing else {
            return Ok(None);
        };
        let found = classify(run.scene, list, projected, chunks, verdicts, self.options.culling)?;
        if *number == 0 {
            let _ = self.classified.set(found.to_string());
        }
        Ok(Some(found.colors))
    }

    fn shadowing(&self, drawing: &Drawing<'_>) -> Result<Shadowing, Error> {
        Shadowing::new(drawing.run.scene, drawing.list, &self.options, &drawing.eye())
    }

    /// Shadows by what the first pass sees, whichever pass asks.
    fn shadows_of_all(&self, drawing: &Drawing<'_>, pool: &rayon::ThreadPool) -> Result<&Shadowing, Error> {
        // Shadow maps depend on the first pass alone, so that all passes show the same ones.
        if self.shadows.get().is_none() {
            let made = pool.install(|| match drawing.number {
                0 => self.shadowing(drawing),
                _ => self.shadowing(&self.drawing(drawing.run, drawing.list, 0)?),
            })?;
            let _ = self.shadows.set(made);
        }
        self.shadows.get().ok_or_else(|| Error::Scene("no shadows were made".into()))
    }

    /// Light of the triangles that the picture sees at the points of the shading model, and the counters of its rays;
    /// empty for models of pixels. `None` where the render was cancelled.
    fn triangle_light(&self, drawing: &Drawing<'_>, shadows: &Shadowing) -> Option<(TriangleLight, Counters)> {
        let Drawing { run, list, projected, visibility, .. } = drawing;
        let (scene, points) = (run.scene, self.options.shading.points());
        if points.is_empty() || self.options.show != Show::Picture {
            return Some(<_>::default());
        }
        let shader = self.shader(drawing, shadows);
        let width = scene.film().crop.width();
        // One pixel of each triangle tells what is seen there.
        let of_pixel = |pixel: u32| {
            let seen = visibility.seen(scene, list, projected, [pixel % width, pixel / width])?;
            matches!(scene.geometry(seen.hit.id).shape, Shape::Mesh(_)).then_some(seen)
        };
        let all: Vec<Seen> = visibility.first_pixels().into_iter().filter_map(of_pixel).collect();
        let (found, counters) = run.in_order(all.len(), |k, counters| {
            let at = |uv: &[f32; 2]| {
                let (p, ray, seen) = view_of(scene, projected, all[k], *uv);
                self.shade(drawing, &shader, (&ray, Some(seen)), (key(p), None), counters)
            };
            (all[k].number, points.iter().map(at).collect())
        })?;
        Some((TriangleLight { triangles: found }, counters))
    }

    fn shader<'a>(&'a self, drawing: &Drawing<'a>, shadows: &'a Shadowing) -> Shader<'a> {
        let (scene, seed) = (drawing.run.scene, drawing.run.sampler.seed);
        let clusters = self.clusters.get();
        let kind = self.options.environment;
        let image_lights =
            (kind != EnvironmentKind::Sampled).then(|| self.image_lights.get_or_init(|| ImageLights::new(scene, kind)));
        Shader {
            scene,
            shadows,
            options: &self.options,
            depth: &self.depth,
            pass: drawing.number,
            seed,
            image_lights,
            clusters,
        }
    }

    fn pixel(
        &self,
        drawing: &Drawing<'_>,
        (shadows, triangles): (&Shadowing, &TriangleLight),
        at: [u32; 2],
        counters: &mut Counters,
    ) -> Found {
        let Drawing { run, list, projected, visibility, .. } = drawing;
        let scene = run.scene;
        // Intersect the pixel's ray with the primitive that the visibility buffer names.
        let seen = visibility.seen(scene, list, projected, at);
        let pixel = (at[1] * scene.film().crop.width() + at[0]) as usize;
        if self.options.show == Show::Clip {
            let item = visibility.item(pixel);
            let shown = item.zip(seen).map(|(item, seen)| lesson::clipping(scene, list, projected, item, &seen));
            return Found::of(shown.unwrap_or(Vec3::ZERO));
        }
        let ray = projected.ray(scene, at);
        let shader = self.shader(drawing, shadows);
        if self.options.show != Show::Picture {
            return Found::of(shader.view(&ray, seen));
        }
        let light = seen.as_ref().and_then(|seen| triangles.at(seen));
        let mut found =
            light.unwrap_or_else(|| self.shade(drawing, &shader, (&ray, seen), (at, Some(pixel)), counters));
        // Transparent layers before it, each lit as a surface of its own.
        if let Some(layers) = &drawing.layers {
            let (layers, rest) = layers.of(pixel);
            found.scale(rest);
            for (fragment, share) in layers {
                let seen = Some(fragment.seen);
                found.add(&self.shade(drawing, &shader, (&ray, seen), (at, None), counters), *share);
            }
        }
        // A transparent background leaves pixels without coverage black; shadow catchers show their shadows.
        if self.transparent || scene.has_shadow_catchers() {
            let sight = Sight { sees_through: false, hide_emitters: self.depth.hide_emitters };
            let lambda = shader.wavelengths(at);
            let hit = first_hit(scene, ray, &lambda, sight, None);
            if let Some(shown) = shadow_catcher::shown(scene, &ray, &hit, self.transparent, &lambda) {
                let value = scene.film().to_rgb(shown, &lambda, scene.mode()) * drawing.weight;
                return Found { value, lights: vec![Vec3::ZERO; found.lights.len()] };
            }
        }
        found
    }

    /// Shades the point that a ray sees: its radiance in the colours of the film, split by the groups of lights.
    /// `at` chooses its random numbers; `pixel` is the one that sees it, while shadows of pixels apply.
    fn shade(
        &self,
        drawing: &Drawing<'_>,
        shader: &Shader<'_>,
        (ray, seen): (&Ray, Option<Seen>),
        (at, pixel): ([u32; 2], Option<usize>),
        counters: &mut Counters,
    ) -> Found {
        let scene = drawing.run.scene;
        let mut lambda = shader.wavelengths(at);
        counters.parts.clear();
        let groups = if self.by_light { scene.light_groups().names.len() } else { 0 };
        counters.parts.resize(groups, Spectrum::ZERO);
        let mut trace = Trace { counters, pixel, world: None };
        let radiance = shader.radiance(ray, seen, &shader.numbers(at), &mut lambda, &mut trace);
        // Exposure may clamp the radiance; the light of groups is scaled alike, so that groups still add up to the
        // picture.
        let exposed = scene.film().exposed(radiance);
        let scale = if exposed.is_black() { 0.0 } else { exposed.max_element() / radiance.max_element() };
        let rgb = |light| scene.film().to_rgb(light, &lambda, scene.mode()) * drawing.weight;
        Found { value: rgb(exposed), lights: counters.parts.iter().map(|light| rgb(*light * scale)).collect() }
    }
}

impl Drawing<'_> {
    fn eye(&self) -> Eye<'_> {
        Eye { projected: &self.projected, visibility: &self.visibility }
    }
}

impl Pass for Rasterizer {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.preparation.make(run)
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        self.preparation.outcome(self.draw(run, number, film))
    }

    fn first_ray(&self, run: &Run<'_>, pixel: [u32; 2], number: u32) -> (Ray, Wavelengths) {
        first_ray(run.scene, pixel, number)
    }

    fn notes(&self) -> Vec<String> {
        let wrong = |pixels| format!("the order of the painter's algorithm is wrong in {pixels} pixels");
        let culling = self.culled.get().into_iter().chain(self.classified.get()).cloned();
        let cells = |clusters: &Clusters| format!("{:.1} lights in a cell, in the mean", clusters.mean_count());
        let clusters = self.clusters.get().map(cells);
        self.wrong.get().map(wrong).into_iter().chain(culling).chain(clusters).collect()
    }

    fn failure(&self) -> Option<String> {
        self.preparation.failure()
    }
}

/// The ray through the place of a pixel that a pass looks at, and its wavelengths.
pub(crate) fn first_ray(scene: &Scene, [x, y]: [u32; 2], number: u32) -> (Ray, Wavelengths) {
    let (offset, _) = place(scene.film(), number);
    let ray = scene.camera().ray(scene.film(), Vec2::new(x as f32, y as f32) + offset, Vec2::splat(0.5));
    (ray, scene.mode().wavelengths(|| 0.5))
}

/// The place in each pixel that a pass looks at, from its top left, and its weight: the centre first, then spread as
/// the pixel filter is.
pub(crate) fn place(film: &FilmSpec, number: u32) -> (Vec2, f32) {
    let u = spread(number);
    let (offset, weight) = film.filter.sample(u);
    (if number == 0 { u } else { offset + 0.5 }, weight)
}
