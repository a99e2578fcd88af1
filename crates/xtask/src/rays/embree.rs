//! Embree 4, loaded at run time: of its public C interface what a comparison needs.
//!
//! Embree API, version 4: <https://github.com/RenderKit/embree/blob/master/doc/src/api.md>. Structures and numbers are
//! those of its headers for one level of instances.
#![expect(unsafe_code, reason = "calls of a C library")]

use super::{
    judge::Claim,
    trace::{Found, Query},
};
use crate::{clock::timed, generate::Mesh};
use libloading::Library;
use std::{
    error::Error,
    ffi::{CString, c_char, c_int, c_uint, c_void},
    mem::ManuallyDrop,
    path::Path,
    ptr::{null, null_mut},
    sync::atomic::{AtomicIsize, Ordering},
};
use steradian_math::{Ray, transform::Affine};

type Object = *mut c_void;
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;
type Single = unsafe extern "C" fn(Object, *mut c_void, *const Arguments);
type Packet = unsafe extern "C" fn(*const c_int, Object, *mut c_void, *const Arguments);

/// Functions of the library, by their names there.
macro_rules! functions {
    ($($name:ident = $symbol:literal: $ty:ty;)*) => {
        /// The library.
        pub struct Embree {
            $($name: $ty,)*
        }

        impl Embree {
            /// Loads the library, which stays in memory: its threads end with the program.
            fn bind(path: &Path) -> Result<Self, Box<dyn Error>> {
                // SAFETY: the user names Embree's library, whose functions have these types.
                unsafe {
                    let library = ManuallyDrop::new(Library::new(path)?);
                    Ok(Self { $($name: *library.get::<$ty>($symbol)?,)* })
                }
            }
        }
    };
}

functions! {
    new_device = c"rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Object;
    release_device = c"rtcReleaseDevice": unsafe extern "C" fn(Object);
    device_error = c"rtcGetDeviceError": unsafe extern "C" fn(Object) -> c_int;
    set_memory_monitor = c"rtcSetDeviceMemoryMonitorFunction": unsafe extern "C" fn(Object, Monitor, *mut c_void);
    new_scene = c"rtcNewScene": unsafe extern "C" fn(Object) -> Object;
    release_scene = c"rtcReleaseScene": unsafe extern "C" fn(Object);
    set_scene_flags = c"rtcSetSceneFlags": unsafe extern "C" fn(Object, c_int);
    commit_scene = c"rtcCommitScene": unsafe extern "C" fn(Object);
    new_geometry = c"rtcNewGeometry": unsafe extern "C" fn(Object, c_int) -> Object;
    release_geometry = c"rtcReleaseGeometry": unsafe extern "C" fn(Object);
    commit_geometry = c"rtcCommitGeometry": unsafe extern "C" fn(Object);
    attach_geometry = c"rtcAttachGeometry": unsafe extern "C" fn(Object, Object) -> c_uint;
    new_buffer = c"rtcSetNewGeometryBuffer":
        unsafe extern "C" fn(Object, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
    set_instanced_scene = c"rtcSetGeometryInstancedScene": unsafe extern "C" fn(Object, Object);
    set_transform = c"rtcSetGeometryTransform": unsafe extern "C" fn(Object, c_uint, c_int, *const f32);
    intersect1 = c"rtcIntersect1": Single;
    intersect4 = c"rtcIntersect4": Packet;
    intersect8 = c"rtcIntersect8": Packet;
    intersect16 = c"rtcIntersect16": Packet;
    occluded1 = c"rtcOccluded1": Single;
    occluded4 = c"rtcOccluded4": Packet;
    occluded8 = c"rtcOccluded8": Packet;
    occluded16 = c"rtcOccluded16": Packet;
}

const GEOMETRY_TRIANGLE: c_int = 0;
const GEOMETRY_INSTANCE: c_int = 121;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const FORMAT_FLOAT3X4_COLUMN_MAJOR: c_int = 0x9234;
const SCENE_ROBUST: c_int = 1 << 2;
const QUERY_COHERENT: c_int = 1 << 16;
const INVALID: u32 = u32::MAX;

/// `RTCIntersectArguments` and `RTCOccludedArguments`.
#[repr(C)]
struct Arguments {
    flags: c_int,
    features: c_uint,
    context: *const c_void,
    filter: *const c_void,
    function: *const c_void,
    min_width_distance_factor: f32,
}

/// `RTCRay` followed by `RTCHit` for so many rays, by rows: `RTCRayHit`, `RTCRayHit4` and so on, which begin with the
/// ray.
#[repr(C, align(64))]
struct RayHits<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    uv: [[f32; N]; 2],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [[u32; N]; 2],
}

impl<const N: usize> RayHits<N> {
    fn new() -> Self {
        Self {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            uv: [[0.0; N]; 2],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [[INVALID; N]; 2],
        }
    }

    /// A ray at a place, without a hit.
    #[inline(always)]
    fn set(&mut self, place: usize, ray: &Ray) {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        for axis in 0..3 {
            self.origin[axis][place] = origin[axis];
            self.direction[axis][place] = direction[axis];
        }
        self.t_far[place] = ray.t_max;
        self.geometry[place] = INVALID;
    }

    /// Adds what the first rays have found.
    #[inline(always)]
    fn add_to(&self, found: &mut Found, query: Query, count: usize) {
        let rays = self.geometry[..count].iter().zip(&self.t_far);
        match query {
            Query::Closest => found.add(rays.filter(|(geometry, _)| **geometry != INVALID).map(|(_, t)| *t)),
            Query::Occluded => found.hits += rays.filter(|(_, t)| **t < 0.0).count(),
        }
    }
}

/// Packing of rays in calls.
#[derive(Clone, Copy, Debug)]
pub struct Packing {
    /// One, four, eight or sixteen at a time.
    pub width: usize,
    /// True if they are declared coherent.
    pub coherent: bool,
}

impl Packing {
    /// Every way.
    pub fn all() -> impl Iterator<Item = Self> {
        [1, 4, 8, 16].into_iter().flat_map(|width| [false, true].map(|coherent| Self { width, coherent }))
    }
}

/// A scene that was built.
pub struct Built<'a> {
    embree: &'a Embree,
    device: Object,
    /// The mesh, and above it the instances if there are any.
    scenes: Vec<Object>,
    /// Bytes allocated by the device, and bytes of its copy of the mesh in them.
    allocated: Box<AtomicIsize>,
    copy: usize,
    /// CPU seconds of all threads, and seconds by the clock, in which it was built.
    pub cpu_seconds: f64,
    pub seconds: f64,
}

/// Which rays of a packet there are.
#[repr(C, align(64))]
struct Valid<const N: usize>([c_int; N]);

/// Adds what the library has allocated or freed.
unsafe extern "C" fn count(total: *mut c_void, bytes: isize, _: bool) -> bool {
    // SAFETY: this is what `build` has given, and it lives longer than the device.
    unsafe { (*total.cast::<AtomicIsize>()).fetch_add(bytes, Ordering::Relaxed) };
    true
}

impl Embree {
    /// Loads the library, and makes a device of two threads that is never used and ends with the program: from the
    /// second device on that has one thread, while there is none with more, a thread of Embree's turns without an end,
    /// on a processor that others are measured on.
    ///
    /// # Errors
    /// When there is none, or it is not Embree 4.
    pub fn load(path: &Path) -> Result<Self, Box<dyn Error>> {
        let embree = Self::bind(path)?;
        // SAFETY: the function is what its type says.
        unsafe { (embree.new_device)(c"threads=2".as_ptr()) };
        Ok(embree)
    }

    /// Builds a mesh, or instances of it, with medium quality on so many threads.
    ///
    /// # Errors
    /// When the library says so.
    pub fn build(
        &self,
        mesh: &Mesh,
        places: &[Affine],
        robust: bool,
        threads: usize,
    ) -> Result<Built<'_>, Box<dyn Error>> {
        let config = CString::new(format!("threads={threads},set_affinity=0"))?;
        let allocated = Box::new(AtomicIsize::new(0));
        let flags = if robust { SCENE_ROBUST } else { 0 };
        // SAFETY: objects live as long as they are used, and buffers are as long as what is written there.
        unsafe {
            let device = (self.new_device)(config.as_ptr());
            (self.set_memory_monitor)(device, count, std::ptr::from_ref(&*allocated).cast_mut().cast());
            let scene = (self.new_scene)(device);
            let copy = size_of_val(&mesh.0[..]) + size_of_val(&mesh.1[..]);
            let scenes = vec![scene];
            let mut built = Built { embree: self, device, scenes, allocated, copy, cpu_seconds: 0.0, seconds: 0.0 };
            self.attach(device, scene, GEOMETRY_TRIANGLE, |geometry| {
                self.fill(geometry, BUFFER_VERTEX, FORMAT_FLOAT3, &mesh.0);
                self.fill(geometry, BUFFER_INDEX, FORMAT_UINT3, &mesh.1);
            });
            built.commit(scene, flags);
            if !places.is_empty() {
                let top = (self.new_scene)(device);
                built.scenes.push(top);
                for place in places {
                    self.attach(device, top, GEOMETRY_INSTANCE, |geometry| {
                        (self.set_instanced_scene)(geometry, scene);
                        let columns: [[f32; 3]; 4] = place.m.to_cols_array_2d().map(|[x, y, z, _]| [x, y, z]);
                        (self.set_transform)(
                            geometry,
                            0,
                            FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            columns.as_flattened().as_ptr(),
                        );
                    });
                }
                built.commit(top, flags);
            }
            match (self.device_error)(device) {
                0 => Ok(built),
                code => Err(format!("Embree fails with error {code}").into()),
            }
        }
    }

    /// Adds a geometry to a scene.
    ///
    /// # Safety
    /// The device and the scene must be alive.
    unsafe fn attach(&self, device: Object, scene: Object, kind: c_int, describe: impl FnOnce(Object)) {
        // SAFETY: the caller's promise; the scene keeps the geometry alive.
        unsafe {
            let geometry = (self.new_geometry)(device, kind);
            describe(geometry);
            (self.commit_geometry)(geometry);
            (self.attach_geometry)(scene, geometry);
            (self.release_geometry)(geometry);
        }
    }

    /// Fills a new buffer of a geometry with elements of twelve bytes.
    ///
    /// # Safety
    /// The geometry must be alive.
    unsafe fn fill<T: Copy>(&self, geometry: Object, kind: c_int, format: c_int, elements: &[T]) {
        const { assert!(size_of::<T>() == 12) };
        // SAFETY: the library gives room for so many elements.
        unsafe {
            let buffer = (self.new_buffer)(geometry, kind, 0, format, size_of::<T>(), elements.len());
            std::ptr::copy_nonoverlapping(elements.as_ptr(), buffer.cast(), elements.len());
        }
    }
}

impl Built<'_> {
    /// Builds a scene.
    ///
    /// # Safety
    /// The scene must be alive.
    unsafe fn commit(&mut self, scene: Object, flags: c_int) {
        let start = std::time::Instant::now();
        // SAFETY: the caller's promise.
        let ((), cpu_seconds) = timed(|| unsafe {
            (self.embree.set_scene_flags)(scene, flags);
            (self.embree.commit_scene)(scene);
        });
        self.cpu_seconds += cpu_seconds;
        self.seconds += start.elapsed().as_secs_f64();
    }

    /// Memory of the scene in bytes without the library's copy of the mesh.
    pub fn bytes(&self) -> usize {
        (self.allocated.load(Ordering::Relaxed).max(0) as usize).saturating_sub(self.copy)
    }

    /// Traces rays.
    pub fn trace(&self, rays: &[Ray], query: Query, Packing { width, coherent }: Packing) -> Found {
        let embree = self.embree;
        let arguments = Arguments {
            flags: if coherent { QUERY_COHERENT } else { 0 },
            features: u32::MAX,
            context: null(),
            filter: null(),
            function: null(),
            min_width_distance_factor: 0.0,
        };
        let packet = |closest: Packet, occluded: Packet| match query {
            Query::Closest => closest,
            Query::Occluded => occluded,
        };
        match width {
            1 => self.one_by_one(rays, query, &arguments),
            4 => self.packets::<4>(rays, query, packet(embree.intersect4, embree.occluded4), &arguments),
            8 => self.packets::<8>(rays, query, packet(embree.intersect8, embree.occluded8), &arguments),
            _ => self.packets::<16>(rays, query, packet(embree.intersect16, embree.occluded16), &arguments),
        }
    }

    /// The nearest hits of rays, one by one.
    pub fn nearest(&self, rays: &[Ray]) -> Vec<Option<Claim>> {
        let arguments = Arguments {
            flags: 0,
            features: u32::MAX,
            context: null(),
            filter: null(),
            function: null(),
            min_width_distance_factor: 0.0,
        };
        let (top, mut one) = (self.top(), RayHits::<1>::new());
        let mut claim = |ray: &Ray| {
            one.set(0, ray);
            one.instance = [[INVALID]; 2];
            // SAFETY: the structures are those of the interface.
            unsafe { (self.embree.intersect1)(top, (&raw mut one).cast(), &arguments) };
            let instance = if one.instance[0][0] == INVALID { 0 } else { one.instance[0][0] as usize };
            (one.geometry[0] != INVALID).then(|| Claim { instance, triangle: one.primitive[0] as usize })
        };
        rays.iter().map(&mut claim).collect()
    }

    /// The scene that rays go through.
    fn top(&self) -> Object {
        self.scenes.last().copied().unwrap_or(null_mut())
    }

    fn one_by_one(&self, rays: &[Ray], query: Query, arguments: &Arguments) -> Found {
        let (top, mut found) = (self.top(), Found::default());
        let mut one = RayHits::<1>::new();
        let function = match query {
            Query::Closest => self.embree.intersect1,
            Query::Occluded => self.embree.occluded1,
        };
        for ray in rays {
            one.set(0, ray);
            // SAFETY: the structures are those of the interface.
            unsafe { function(top, (&raw mut one).cast(), arguments) };
            one.add_to(&mut found, query, 1);
        }
        found
    }

    fn packets<const N: usize>(&self, rays: &[Ray], query: Query, function: Packet, arguments: &Arguments) -> Found {
        let (top, mut found) = (self.top(), Found::default());
        let mut packet = RayHits::<N>::new();
        for rays in rays.chunks(N) {
            let mut valid = Valid([0; N]);
            for (place, ray) in rays.iter().enumerate() {
                packet.set(place, ray);
                valid.0[place] = -1;
            }
            // SAFETY: the structures are those of the interface.
            unsafe { function(valid.0.as_ptr(), top, (&raw mut packet).cast(), arguments) };
            packet.add_to(&mut found, query, rays.len());
        }
        found
    }
}

impl Drop for Built<'_> {
    fn drop(&mut self) {
        // SAFETY: nothing uses them any longer; instances go before what they are of.
        unsafe {
            for &scene in self.scenes.iter().rev() {
                (self.embree.release_scene)(scene);
            }
            (self.embree.release_device)(self.device);
        }
    }
}
