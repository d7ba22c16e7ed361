//! Grading of ray tracers: somebody else's program is run over a suite of scenes, and its pictures are compared with
//! those of our own renderer.
//!
//! A [`suite::Suite`] says what is rendered and what it is worth, a [`template::Template`] how the program is called,
//! [`grade::grade`] runs it, never trusting it, and [`report`] tells the outcome. Where a picture is wrong, it is also
//! compared with pictures of scenes that were changed on purpose ([`variants`]): the one that it matches names the
//! likely fault. The renderer itself knows nothing of this.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod error;

pub mod settings;

pub mod bent;

pub mod variants;

pub mod suite;

pub mod template;

pub mod snapshot;

pub mod case;

pub mod score;

pub mod hint;

mod sweep;

pub mod process;

pub mod grade;

pub mod report;
