//! Structures written and read again have the same bits; bytes of anything else are an error.

use crate::worlds::{in_cube, ray, scene, two_geometries};
use std::sync::Arc;
use steradian_math::{Bounds3, hash::HashRng};
use steradian_rt::{
    BottomLevel, BoxGeometry, BuildOptions, Geometries, Instance, LoadError, RayFlags, RayQuery, TopLevel,
};

#[test]
fn structures_come_back_with_the_same_hits() {
    let mut rng = HashRng::new(20);
    let level = two_geometries(&mut rng, 300);
    let bytes = level.serialize();
    let again = Arc::new(BottomLevel::deserialize(&bytes).expect("its own bytes"));
    assert_eq!(again.serialize(), bytes);
    let scene = |level| TopLevel::build(&[Instance::new(level)], BuildOptions::default()).expect("valid");
    let (a, b) = (scene(level), scene(again));
    let hits = (0..5000).filter(|_| {
        let ray = ray(&mut rng);
        let hit = |scene| {
            let mut query = RayQuery::new(Some(scene), RayFlags::FORCE_OPAQUE, 0xff, ray).expect("legal");
            assert!(query.proceed().is_none());
            query.committed().map(|hit| (hit.t.to_bits(), hit.primitive.id(), hit.kind, hit.barycentrics))
        };
        assert_eq!(hit(&a), hit(&b));
        hit(&a).is_some()
    });
    assert!(hits.count() > 1000);
}

#[test]
fn bytes_that_are_no_structure_are_errors() {
    let mut rng = HashRng::new(21);
    let boxes = [0; 5].map(|_| Bounds3::new(in_cube(&mut rng), in_cube(&mut rng)));
    let boxes = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), BuildOptions::default());
    let mut errors = 0;
    for bytes in [boxes.expect("valid").serialize(), two_geometries(&mut rng, 5).serialize()] {
        assert!(BottomLevel::deserialize(&bytes).is_ok_and(|level| level.serialize() == bytes));
        for end in 0..bytes.len() {
            assert_eq!(BottomLevel::deserialize(&bytes[..end]).err(), Some(LoadError::TooShort));
        }
        let longer = [&bytes[..], &[0, 0]].concat();
        assert_eq!(BottomLevel::deserialize(&longer).err(), Some(LoadError::TooLong { bytes: 2 }));
        // The version follows eight bytes.
        let mut newer = bytes.clone();
        newer[8] = 3;
        let version = Some(LoadError::Version { version: 3, readable: 2 });
        assert_eq!(BottomLevel::deserialize(&newer).err(), version);
        for _ in 0..3000 {
            let mut broken = bytes.clone();
            let place = (rng.next_u64() % 60) as usize;
            broken[place] = rng.next_u64() as u8;
            errors += usize::from(BottomLevel::deserialize(&broken).is_err());
        }
    }
    assert!(errors > 1000, "{errors} errors");
}

#[test]
fn top_levels_come_back_over_their_bottom_levels() {
    let mut rng = HashRng::new(22);
    let (scene, instances) = scene(&mut rng);
    let bytes = scene.serialize();
    let levels = scene.bottom_levels();
    let handles: Vec<u64> = levels.iter().map(|level| level.handle()).collect();
    assert_eq!(TopLevel::serialized_handles(&bytes), Ok(handles.clone()));
    // Other objects with the same content do as well.
    let copies: Vec<_> = { levels.iter() }
        .map(|level| Arc::new(BottomLevel::deserialize(&level.serialize()).expect("its own bytes")))
        .collect();
    let again = TopLevel::deserialize(&bytes, &copies).expect("its own bytes");
    assert!(again.same_bits(&scene) && again.serialize() == bytes && again.instance_count() == instances.len());
    let hits = (0..3000).filter(|_| {
        let ray = ray(&mut rng);
        let hit = |scene| {
            let mut query = RayQuery::new(Some(scene), RayFlags::FORCE_OPAQUE, 0xff, ray).expect("legal");
            assert!(query.proceed().is_none());
            let hit = query.committed()?;
            let place = (hit.primitive.custom_index(), hit.primitive.object_to_world());
            Some((hit.t.to_bits(), hit.primitive.id(), hit.kind, place))
        };
        assert_eq!(hit(&scene), hit(&again));
        hit(&scene).is_some()
    });
    assert!(hits.count() > 500);

    let wrong = |levels: &[Arc<BottomLevel>]| TopLevel::deserialize(&bytes, levels).err();
    let count = LoadError::BottomLevelCount { expected: 2, given: 1 };
    assert_eq!((levels.len(), wrong(&levels[..1])), (2, Some(count)));
    let swapped = LoadError::BottomLevel { place: 0, expected: handles[0], given: handles[1] };
    assert_eq!(wrong(&[levels[1].clone(), levels[0].clone()]), Some(swapped));
    let other_kind = Some(LoadError::NoStructure { what: "top-level structure" });
    assert_eq!(TopLevel::deserialize(&levels[0].serialize(), &levels).err(), other_kind);
}

#[test]
fn bytes_that_are_no_top_level_are_errors() {
    let mut rng = HashRng::new(23);
    let (scene, _) = scene(&mut rng);
    let (bytes, levels) = (scene.serialize(), scene.bottom_levels());
    for end in 0..bytes.len() {
        assert_eq!(TopLevel::deserialize(&bytes[..end], &levels).err(), Some(LoadError::TooShort));
    }
    let longer = [&bytes[..], &[0; 3]].concat();
    assert_eq!(TopLevel::deserialize(&longer, &levels).err(), Some(LoadError::TooLong { bytes: 3 }));
    let mut newer = bytes.clone();
    newer[8] = 2;
    let version = Some(LoadError::Version { version: 2, readable: 1 });
    assert_eq!(TopLevel::deserialize(&newer, &levels).err(), version);
    let mut errors = 0;
    for _ in 0..3000 {
        let mut broken = bytes.clone();
        let place = (rng.next_u64() % bytes.len() as u64) as usize;
        broken[place] = rng.next_u64() as u8;
        errors += usize::from(TopLevel::deserialize(&broken, &levels).is_err());
    }
    assert!(errors > 300, "{errors} errors");
}
