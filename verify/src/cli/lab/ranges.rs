//! One option for every knob of a case.

use anyhow::Result;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use mtled_case::scene::{Knob, Levels};
use mtled_lab::lab::sweep::Axis;

/// Ranges of settings by option; written by hand, so that a new knob needs no option here.
#[derive(Debug, Default)]
pub(crate) struct Ranges {
    given: Vec<(Knob, String)>,
}

impl Ranges {
    /// The axes that were given.
    pub(crate) fn axes(&self) -> Result<Vec<Axis>> {
        let axes = self.given.iter().map(|(knob, text)| Axis::parse(*knob, text));
        Ok(axes.collect::<Result<_, _>>()?)
    }
}

impl Args for Ranges {
    fn augment_args(command: Command) -> Command {
        let flags = Knob::ALL.iter().filter_map(|knob| Some((knob, knob.flag()?)));
        command.args(flags.map(|(knob, flag)| {
            let value = if let Levels::Word(_) = knob.levels() { "LIST" } else { "RANGE" };
            Arg::new(knob.name())
                .long(flag)
                .help(knob.help())
                .value_name(value)
                .help_heading("Ranges")
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Ranges::augment_args(command)
    }
}

impl FromArgMatches for Ranges {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Ranges, Error> {
        let given = Knob::ALL
            .iter()
            .filter(|knob| knob.flag().is_some())
            .filter_map(|&knob| Some((knob, matches.get_one::<String>(knob.name())?.clone())));
        Ok(Ranges { given: given.collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Ranges::from_arg_matches(matches)?;
        Ok(())
    }
}
