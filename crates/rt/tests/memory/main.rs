//! Memory taken by builds, counted by the allocator, is within the sizes given before. A program of its own, since it
//! counts everything that is allocated.
#![expect(unsafe_code, reason = "a counting allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::{
    BottomLevel, BoxGeometry, BuildOptions, Geometries, Instance, Preference, PrimitiveCounts, TopLevel, Transform3x4,
    TriangleGeometry,
};

/// Bytes that are allocated, and the most that there were.
struct Counting;
static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: the system's allocator does all. Arrays that grow are copied, so that both of them count.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Relaxed) + layout.size();
        MOST.fetch_max(now, Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Result of `make`, the number of bytes that it leaves allocated, and the peak number while it runs.
fn counted<T>(make: impl FnOnce() -> T) -> (T, u64, u64) {
    let before = NOW.load(Relaxed);
    MOST.store(before, Relaxed);
    let made = make();
    (made, NOW.load(Relaxed).saturating_sub(before) as u64, (MOST.load(Relaxed) - before) as u64)
}

#[test]
fn building_takes_no_more_than_was_said() {
    let mut rng = HashRng::new(50);
    let mut point = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
    // Threads and what they need once are made by a build before.
    let corners: Vec<Vec3> = (0..300_000).map(|_| point()).collect();
    let build = |corners: &[Vec3], options| {
        BottomLevel::build(Geometries::Triangles(&[TriangleGeometry::new(corners)]), options).expect("valid")
    };
    let any = Arc::new(build(&corners, BuildOptions::default()));
    let mut shares = Vec::new();
    for preference in [Preference::Balanced, Preference::FastTrace, Preference::FastBuild] {
        let options = BuildOptions { preference, allow_update: true, ..BuildOptions::default() };
        for count in [0, 1, 2, 1000, 100_000] {
            let corners = &corners[..3 * count];
            let boxes: Vec<_> = corners.iter().map(|p| Bounds3 { min: *p, max: *p + 0.1 }).take(count).collect();
            // One triangle is lost, so that the hierarchy is built anew.
            let mut moved: Vec<Vec3> = corners.iter().map(|p| p * 1.5).collect();
            moved.iter_mut().take(3).for_each(|p| *p = Vec3::ONE);
            let place = |p: &Vec3| Instance::new(any.clone()).with_transform(Transform3x4::translation(*p));
            let placed: Vec<_> = corners.iter().map(place).take(count).collect();

            let mut check = |what, bytes: usize, rest: u64, most: u64, structure: u64, scratch: u64| {
                let case = format!("{count} {what}, {preference:?}: {bytes} bytes, {rest} allocated, {most} at most");
                assert!(bytes as u64 <= structure, "{case}; said {structure}");
                assert!(most <= structure + scratch, "{case}; said {structure} and {scratch}");
                assert!(most - rest <= scratch, "{case}; said {scratch} of scratch");
                shares.push((case, (most - rest) as f64 / scratch as f64));
            };
            let said = BottomLevel::sizes(PrimitiveCounts::Triangles(&[count as u64]), options).expect("few");
            let (mut level, rest, most) = counted(|| build(corners, options));
            check("triangles", level.bytes(), rest, most, said.structure, said.build_scratch);
            // What is allocated is what `bytes` counts, but for what the structure itself is.
            assert!(rest.abs_diff(level.bytes() as u64) < 1024, "{rest} allocated, {} counted", level.bytes());
            let geometry = [TriangleGeometry::new(&moved)];
            let (kept, _, most) = counted(|| level.update(Geometries::Triangles(&geometry)).expect("only moved"));
            assert_eq!(kept, count == 0);
            check("moved triangles", level.bytes(), 0, most, said.structure, said.update_scratch);

            let said = BottomLevel::sizes(PrimitiveCounts::Boxes(&[count as u64]), options).expect("few");
            let geometry = [BoxGeometry::new(&boxes)];
            let build = || BottomLevel::build(Geometries::Boxes(&geometry), options).expect("valid");
            let (level, rest, most) = counted(build);
            check("boxes", level.bytes(), rest, most, said.structure, said.build_scratch);

            let said = TopLevel::sizes(count as u64, options).expect("few");
            let (top, rest, most) = counted(|| TopLevel::build(&placed, options).expect("valid"));
            check("instances", top.bytes(), rest, most, said.structure, said.build_scratch);
        }
    }
    // What is said is not out of all proportion.
    for (case, share) in shares.iter().filter(|(case, _)| case.starts_with("100000")) {
        assert!(*share > 0.1, "{case}: {share} of what was said");
    }
}
