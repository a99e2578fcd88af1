//! The parameters that nodes have, to tell misspelt ones. `crates/scene/README.md` says what they mean.

use steradian_schema::{Family, names::did_you_mean};

/// Whether a node of a family has no parameter of that name; then with the nearest one, if there is any.
pub fn unknown(family: Family, kind: &str, name: &str) -> Option<Option<String>> {
    let known = || known(family).split_whitespace();
    // Spectra of coats have names of two parts; kinds that are not ours keep their own parameters.
    if known().any(|k| k == name) || known().next().is_none() || kind.is_empty() {
        return None;
    }
    Some(did_you_mean(name, known()))
}

fn known(family: Family) -> &'static str {
    match family {
        Family::Light => {
            "radiance intensity two_sided scale normalize power file position to_world cone_angle falloff_start
             falloff texture direction illuminance parametrization rows portal fov fov_axis"
        }
        Family::Camera => {
            "to_world medium shutter_open shutter_close to_world_end motion_times fov fov_axis lens_radius focal_distance screen_window
             frame_aspect near far principal_x principal_y mapping"
        }
        Family::Film => "width height crop iso exposure_time sensor white_balance max_component filename",
        Family::Filter => "radius_x radius_y sigma b c tau",
        Family::Medium => {
            "sigma_a sigma_s sigma_t albedo scale phase g Le Lescale density wispiness frequency nx ny nz p0 p1 to_world temperature
            temperatureoffset temperaturescale"
        },
        Family::Phase => "g",
        Family::Shape => {
            "alpha single_sided flat displacement displacement_vector displacement_scale displacement_middle edge_length
             edge_pixels tangents center radius z_min z_max phi_max height inner_radius p0 p1 levels points
             degree basis type width0 width1 normals split_depth heights nu nv file scale smooth normal distance"
        }
        // The compiler knows those of materials one by one; textures and methods have too many of their own.
        _ => "",
    }
}
