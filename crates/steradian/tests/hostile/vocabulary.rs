//! Placeholder while the tables are brought up.
