//! Mesh files: PLY, OBJ with MTL, Mitsuba serialized.
