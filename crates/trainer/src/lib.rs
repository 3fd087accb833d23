//! The command line: registry and wiring.
