//! What was typed about how a scene is read: the same for every command that reads one.

use clap::Args;
use clap::ValueEnum;
use dotray::scene::Dialect;

/// Options of reading.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct ReadingArgs {
    /// The dialect of the language that the scene is written in; auto finds out from the file and what it includes.
    #[arg(long, value_enum, value_name = "NAME", default_value_t, help_heading = "Reading")]
    pub dialect: DialectName,
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
