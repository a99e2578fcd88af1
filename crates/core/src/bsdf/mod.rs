//! Scattering at a point of a surface.
