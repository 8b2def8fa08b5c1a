//! Volume and mesh files.
