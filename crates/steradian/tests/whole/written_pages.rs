//! Pages of the documentation that the program writes, against what it would write now.

use steradian::{schema, schema::Family, support};

#[test]
fn pages_of_families_are_up_to_date() {
    let pages = [
        (Family::Material, include_str!("../../../../docs/materials.md")),
        (Family::Texture, include_str!("../../../../docs/textures.md")),
        (Family::Light, include_str!("../../../../docs/lights.md")),
        (Family::Shape, include_str!("../../../../docs/shapes.md")),
        (Family::Camera, include_str!("../../../../docs/cameras.md")),
        (Family::Medium, include_str!("../../../../docs/media.md")),
        (Family::Phase, include_str!("../../../../docs/phases.md")),
        (Family::Film, include_str!("../../../../docs/films.md")),
        (Family::Filter, include_str!("../../../../docs/filters.md")),
        (Family::Integrator, include_str!("../../../../docs/integrators.md")),
    ];
    for (family, page) in pages {
        let list = family.plural();
        assert!(page == schema::page(family), "run: steradian list {list} --markdown > docs/{list}.md");
    }
}

#[test]
fn the_page_of_limits_is_up_to_date() {
    let page = support::page().expect("answers");
    assert!(
        page == include_str!("../../../../docs/integrators/limits.md"),
        "run: steradian list limits --markdown > docs/integrators/limits.md"
    );
}
