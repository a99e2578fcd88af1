//! pbrt-v4 scene files.
