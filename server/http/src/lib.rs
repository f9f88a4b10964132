//! The HTTP interface: a router over the engine.
