//! Whole scenes through the library, one program: each file is about one thing that its head names.

mod ambient;
mod auto;
mod bands;
mod clusters;
mod colours;
mod cube_maps;
mod culling;
mod denoising;
mod edits;
mod estimate;
mod every_method;
mod exchange;
mod far_away;
mod fluorescence;
mod gallery;
mod halves;
mod hybrid;
mod image_light;
mod media_plugins;
mod meter;
mod motion;
mod openpbr;
mod own_language;
mod own_methods;
mod own_models;
mod phosphorescence;
mod planes;
#[path = "../../examples/plugin/main.rs"]
#[allow(dead_code, reason = "tests include this file")]
mod plugin;
mod preview;
mod projections;
mod raster;
mod ray_pipeline;
mod references;
mod shading_models;
mod shadow_catcher;
mod single_sided;
mod structures;
mod subsurface;
mod texture_plugins;
mod transient;
mod transparency;
mod volumes;
mod waves;
mod written_pages;
