//! Intel's Open Image Denoise 2, loaded at run time: of its public C interface what a picture needs.
//!
//! Open Image Denoise, "Open Image Denoise API": <https://github.com/RenderKit/oidn/blob/master/README.md>. The numbers
//! are those of its header `oidn.h`. Albedo and normals are noisy themselves; each is filtered alone before it guides,
//! which its documentation calls prefiltering.
//!
//! What `unsafe` relies on:
//!
//! - Code of a library runs as part of the program. Whoever names its path vouches for it; nothing is searched for, as
//!   paths must be absolute. Functions are taken from it only if all are there, and are used only if it says that it is
//!   version 2, whose header gives their types.
//! - The library stays in memory, as its threads and the functions taken from it may live as long as the program.
//! - Objects of the library are made and released here, filters before their device, and no pointer to one gets out.
//!   They are used by one thread at a time: [`Oidn`] is neither `Send` nor `Sync`.
//! - Images are slices of [`Vec3`], three `f32` without padding, with as many pixels as the library is told. They are
//!   borrowed until their filter is released, and only the outcome's, which is borrowed exclusively, is written to.
#![expect(unsafe_code, reason = "calls of a C library")]

use crate::{error, gbuffer::check_size, image::Image};
use libloading::Library;
use std::{
    ffi::{CStr, c_char, c_int, c_void},
    fmt,
    mem::ManuallyDrop,
    path::Path,
    ptr::null,
};
use steradian_math::Vec3;

/// A device or a filter.
type Object = *mut c_void;

/// The processor, on which images are where they are; others may not see them.
const DEVICE_CPU: c_int = 1;
const FORMAT_FLOAT3: c_int = 3;
/// The version whose functions have these types. The library tells 10 000 times major plus 100 times minor.
const MAJOR: c_int = 2;

/// Why the library does not serve, or did not.
#[derive(Debug)]
pub enum Error {
    /// A path that is not absolute.
    Relative,
    /// A pipe or a device: to open a pipe waits for someone to write.
    Irregular,
    /// The system cannot load it.
    Load(libloading::Error),
    /// A function that it lacks.
    Lacks(&'static str),
    /// A version that is not 2: major and minor.
    Version([c_int; 2]),
    /// Error message of the library.
    Said(String),
    /// Images that are refused.
    Image(error::Error),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Relative => write!(f, "the path of a library is absolute"),
            Self::Irregular => write!(f, "it is not a regular file, as a library is"),
            Self::Load(e) => {
                write!(f, "it is no library that this machine loads: {e}")?;
                std::error::Error::source(e).map_or(Ok(()), |source| write!(f, ": {source}"))
            }
            Self::Lacks(name) => write!(f, "it is not Open Image Denoise 2: it has no function {name}"),
            Self::Version([major, minor]) => write!(f, "it is Open Image Denoise {major}.{minor}; 2 is what is used"),
            Self::Said(message) => write!(f, "Open Image Denoise says: {message}"),
            Self::Image(e) => e.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

impl From<error::Error> for Error {
    fn from(e: error::Error) -> Self {
        Self::Image(e)
    }
}

/// Functions of the library, by their names there.
macro_rules! functions {
    ($($name:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        #[derive(Debug)]
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            fn bind(path: &Path) -> Result<Self, Error> {
                // SAFETY: the user names the library. Its functions have these types if it is of version 2, before
                // which only those are called that tell it.
                unsafe {
                    let library = ManuallyDrop::new(Library::new(path).map_err(Error::Load)?);
                    Ok(Self { $($name: *library.get($symbol).map_err(|_| Error::Lacks($symbol))?,)* })
                }
            }
        }
    };
}

functions! {
    new_device = "oidnNewDevice": fn(c_int) -> Object;
    release_device = "oidnReleaseDevice": fn(Object);
    device_error = "oidnGetDeviceError": fn(Object, *mut *const c_char) -> c_int;
    get_device_int = "oidnGetDeviceInt": fn(Object, *const c_char) -> c_int;
    set_device_int = "oidnSetDeviceInt": fn(Object, *const c_char, c_int);
    set_device_bool = "oidnSetDeviceBool": fn(Object, *const c_char, bool);
    commit_device = "oidnCommitDevice": fn(Object);
    new_filter = "oidnNewFilter": fn(Object, *const c_char) -> Object;
    release_filter = "oidnReleaseFilter": fn(Object);
    set_image = "oidnSetSharedFilterImage":
        fn(Object, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);
    set_filter_bool = "oidnSetFilterBool": fn(Object, *const c_char, bool);
    commit_filter = "oidnCommitFilter": fn(Object);
    execute_filter = "oidnExecuteFilter": fn(Object);
}

/// The library with a device of this machine's processor.
#[derive(Debug)]
pub struct Oidn {
    functions: Functions,
    device: Object,
    version: c_int,
}

impl Oidn {
    /// Loads the library, whose code then is a part of the program. `path` is absolute; `threads` as many as it is to
    /// use, 0 for all.
    ///
    /// # Errors
    /// Where there is no such library, it is not Open Image Denoise 2, or it does not support this machine.
    pub fn load(path: &Path, threads: usize) -> Result<Self, Error> {
        if !path.is_absolute() {
            return Err(Error::Relative);
        }
        if path.metadata().is_ok_and(|meta| !meta.is_file() && !meta.is_dir()) {
            return Err(Error::Irregular);
        }
        let functions = Functions::bind(path)?;
        // SAFETY: the functions are the library's, of which this one is the same in version 1.
        let device = unsafe { (functions.new_device)(DEVICE_CPU) };
        let mut oidn = Self { functions, device, version: 0 };
        if device.is_null() {
            return Err(oidn.told().err().unwrap_or_else(|| Error::Said("there is no device".into())));
        }
        // SAFETY: as above, of a device that is there.
        oidn.version = unsafe { (oidn.functions.get_device_int)(device, c"version".as_ptr()) };
        if oidn.version()[0] != MAJOR {
            return Err(Error::Version(oidn.version()));
        }
        // SAFETY: a device that is there.
        unsafe {
            let set_int = oidn.functions.set_device_int;
            set_int(device, c"numThreads".as_ptr(), c_int::try_from(threads).unwrap_or(c_int::MAX));
            // Threads that are tied to processors would stay so for what else the program does.
            (oidn.functions.set_device_bool)(device, c"setAffinity".as_ptr(), false);
            (oidn.functions.commit_device)(device);
        }
        oidn.told()?;
        Ok(oidn)
    }

    /// Its version, major and minor.
    pub fn version(&self) -> [c_int; 2] {
        [self.version / 10_000, self.version / 100 % 100]
    }

    /// Filters radiance, guided by albedo, from 0 to 1, and by normals, which count only where there is albedo too.
    /// Values that are not finite count as 0, and negative radiance as 0.
    ///
    /// # Errors
    /// Where images have different sizes or no pixels, and where the library fails.
    pub fn denoise(
        &self,
        radiance: &Image<Vec3>,
        albedo: Option<&Image<Vec3>>,
        normal: Option<&Image<Vec3>>,
    ) -> Result<Image<Vec3>, Error> {
        let size = radiance.size();
        if size.contains(&0) {
            return Err(error::Error::Empty.into());
        }
        let guides = [(c"albedo", albedo), (c"normal", normal.filter(|_| albedo.is_some()))];
        let guides = guides.into_iter().filter_map(|(name, image)| Some((name, image?)));
        let clean = guides.map(|(name, image)| {
            check_size(if name == c"albedo" { "albedo" } else { "normal" }, image.size(), size)?;
            Ok((name, self.filter(&[(name, image)], &[])?))
        });
        let clean: Vec<(&CStr, Image<Vec3>)> = clean.collect::<Result<_, Error>>()?;
        let all: Vec<_> = [(c"color", radiance)].into_iter().chain(clean.iter().map(|(n, i)| (*n, i))).collect();
        self.filter(&all, &[c"hdr", c"cleanAux"])
    }

    /// Filters the first of images of one size, with options that are true.
    fn filter(&self, images: &[(&CStr, &Image<Vec3>)], options: &[&CStr]) -> Result<Image<Vec3>, Error> {
        let [width, height] = images[0].1.size();
        let mut outcome = Image::filled(width, height, Vec3::ZERO);
        let functions = &self.functions;
        // SAFETY: the device is there until `self` is dropped. All images have as many pixels as is said, and outlive
        // the filter, which ends here; it reads all but the outcome.
        unsafe {
            let filter = (functions.new_filter)(self.device, c"RT".as_ptr());
            if !filter.is_null() {
                let set = |name: &CStr, pixels: *mut Vec3| {
                    let (width, height) = (width as usize, height as usize);
                    (functions.set_image)(filter, name.as_ptr(), pixels.cast(), FORMAT_FLOAT3, width, height, 0, 0, 0);
                };
                images.iter().for_each(|(name, image)| set(name, image.values().as_ptr().cast_mut()));
                set(c"output", outcome.values_mut().as_mut_ptr());
                options.iter().for_each(|name| (functions.set_filter_bool)(filter, name.as_ptr(), true));
                (functions.commit_filter)(filter);
                (functions.execute_filter)(filter);
                (functions.release_filter)(filter);
            }
        }
        self.told()?;
        Ok(outcome)
    }

    /// Error of the library's earlier calls, if they failed.
    fn told(&self) -> Result<(), Error> {
        let mut message = null();
        // SAFETY: a device that is there, or null for what made none. The text is the library's until its next call.
        unsafe {
            if (self.functions.device_error)(self.device, &raw mut message) == 0 {
                return Ok(());
            }
            let text = if message.is_null() { c"no reason" } else { CStr::from_ptr(message) };
            Err(Error::Said(text.to_string_lossy().into_owned()))
        }
    }
}

impl Drop for Oidn {
    fn drop(&mut self) {
        if !self.device.is_null() {
            // SAFETY: no filter of this device is left.
            unsafe { (self.functions.release_device)(self.device) };
        }
    }
}
