//! What was typed about how a scene is read: the same for every command that reads one.

use clap::Args;
use clap::ValueEnum;
use dotray::scene::Dialect;
use std::path::PathBuf;

use crate::values::ByteCount;

/// Options of reading.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ReadingArgs {
    /// The dialect of the language that the scene is written in; auto finds out from the file and what it includes.
    #[arg(long, value_enum, value_name = "NAME", default_value_t, help_heading = "Reading")]
    pub dialect: DialectName,

    /// How much a scene may ask for.
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// How much a scene may ask for.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Limits of reading")]
pub struct LimitArgs {
    /// Read nothing outside of this folder, be it scene, include or texture; links are followed before that is judged.
    #[arg(long, value_name = "DIR")]
    pub confine: Option<PathBuf>,
    /// The largest file of a scene, also once it is unpacked, in bytes or such as 100M or 4G [default: 4G].
    #[arg(long, value_name = "BYTES")]
    pub max_file_size: Option<ByteCount>,
    /// How many files a scene may have [default: 4096].
    #[arg(long, value_name = "N")]
    pub max_includes: Option<u32>,
    /// How deep included files may include others [default: 64].
    #[arg(long, value_name = "N")]
    pub max_include_depth: Option<u32>,
    /// How deep groups may nest in a file [default: 1048576].
    #[arg(long, value_name = "N")]
    pub max_nesting: Option<u32>,
    /// How many shapes a scene may have, instances counted as often as they stand [default: 2147483648].
    #[arg(long, value_name = "N")]
    pub max_shapes: Option<u32>,
    /// How many groups and runs of shapes of one kind a scene may come to, instances counted as often as they stand
    /// [default: 10000000].
    #[arg(long, value_name = "N")]
    pub max_groups: Option<u32>,
    /// The most memory that shapes, accelerator and picture may take, estimated before it is taken, in bytes or such as
    /// 500M or 4G [default: what the machine has].
    #[arg(long, value_name = "BYTES")]
    pub max_memory: Option<ByteCount>,
}

/// Dialects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum DialectName {
    /// Found out from the file
    #[default]
    Auto,
    /// The lecture slides' own
    Slides,
    /// University of Virginia, Johns Hopkins to 2019
    Uva,
    /// Johns Hopkins since 2020
    Jhu,
    /// Harvey Mudd, CS 155
    Hmc,
    /// University of South Australia
    Unisa,
}

impl DialectName {
    /// The word that was typed.
    pub fn word(self) -> &'static str {
        self.chosen().map_or("auto", Dialect::name)
    }

    /// The dialect; `None` where it is to be found out.
    pub fn chosen(self) -> Option<Dialect> {
        match self {
            Self::Auto => None,
            Self::Slides => Some(Dialect::Slides),
            Self::Uva => Some(Dialect::Uva),
            Self::Jhu => Some(Dialect::Jhu),
            Self::Hmc => Some(Dialect::Hmc),
            Self::Unisa => Some(Dialect::Unisa),
        }
    }
}
