//! The laws of scattering, on every registered model.
