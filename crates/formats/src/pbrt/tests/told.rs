//! Parameters that are not followed.

use super::*;

/// Messages, each with its kind.
fn said(text: &str) -> Vec<String> {
    load(text).diagnostics.iter().map(|d| format!("{}: {}", d.kind(), d.message)).collect()
}

#[test]
fn parameters_without_effect_on_the_picture_are_noted() {
    let quad = "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]";
    for (text, what) in [
        ("Accelerator \"bvh\" \"integer maxnodeprims\" 2 WorldBegin", "'maxnodeprims' of accelerator 'bvh'"),
        ("Accelerator \"kdtree\" \"float emptybonus\" 0.2 WorldBegin", "'emptybonus' of accelerator 'kdtree'"),
        ("Film \"rgb\" \"float diagonal\" 43 WorldBegin", "'diagonal' of film 'rgb'"),
        ("Film \"rgb\" \"bool savefp16\" false WorldBegin", "'savefp16' of film 'rgb'"),
        ("Sampler \"halton\" \"string randomization\" \"none\" WorldBegin", "'randomization' of sampler 'halton'"),
        ("Camera \"spherical\" \"float lensradius\" 1 WorldBegin", "'lensradius' of camera 'spherical'"),
        ("Camera \"spherical\" \"float screenwindow\" [0 1 0 1] WorldBegin", "'screenwindow' of camera 'spherical'"),
        ("Option \"rendercoordsys\" \"world\" WorldBegin", "option 'rendercoordsys'"),
        (
            &format!("WorldBegin Shape \"bilinearmesh\" {quad} \"integer faceIndices\" 1"),
            "'faceIndices' of shape 'bilinearmesh'",
        ),
        (
            &format!("WorldBegin Shape \"loopsubdiv\" {quad} \"integer indices\" [0 1 2] \"string scheme\" \"loop\""),
            "'scheme' of shape 'loopsubdiv'",
        ),
    ] {
        let said = said(text);
        assert!(said.len() == 1 && said[0].starts_with(&format!("note: {what} has no effect: ")), "{text}: {said:?}");
    }
}

#[test]
fn parameters_of_pictures_that_are_not_made_are_left_out() {
    let function = said("Integrator \"function\" \"bool skipbad\" true WorldBegin");
    assert!(function.contains(&"dropped: 'skipbad' of integrator 'function' is left out".into()), "{function:?}");
    let bdpt = said("Integrator \"bdpt\" \"bool visualizeweights\" true WorldBegin");
    assert_eq!(bdpt, ["dropped: pictures of single strategies ('visualizeweights') are not written"]);
    assert!(said("Integrator \"bdpt\" \"bool visualizeweights\" false WorldBegin").is_empty());
}

#[test]
fn accelerators_have_their_own_parameters_only() {
    assert_eq!(
        said("Accelerator \"bvh\" \"integer maxnodeprim\" 2 WorldBegin"),
        ["unused: accelerator 'bvh' has no parameter 'maxnodeprim'"]
    );
}

#[test]
fn the_scale_of_edges_multiplies_the_edges_of_displaced_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(folder.path().join("m.ply"), ply).unwrap();
    let import = load_in(
        folder.path(),
        "Option \"displacementedgescale\" 0.5 WorldBegin
         Shape \"plymesh\" \"string filename\" \"m.ply\" \"float displacement\" 0.1 \"float edgelength\" 3",
    );
    assert_eq!(shape(&import.desc).float("edge_length"), Some(1.5));
    assert!(!errors(&load("Option \"displacementedgescale\" -1 WorldBegin")).is_empty());
}
