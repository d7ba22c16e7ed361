//! The whole way, from files as people write them: the gallery with the program itself, text that is written back,
//! other people's scenes, broken ones.

mod bytes;
mod dialects;
mod fuzzed;
mod gallery;
mod hostile;
mod real_scenes;
mod round_trip;
mod surfaces;
mod tutorial;
