//! Flags for the numbers of the pipeline, generated from their table.

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, value_parser};

use resect_core::pipeline::{PIPELINE_NUMBERS, PipelineSettings};

/// Values of the given flags, in the order of [`PIPELINE_NUMBERS`].
#[derive(Clone, Default)]
pub struct NumberFlags {
    values: [Option<f64>; PIPELINE_NUMBERS.len()],
}

impl NumberFlags {
    /// Sets the numbers whose flags are given.
    pub fn apply(&self, settings: &mut PipelineSettings) {
        for (number, value) in PIPELINE_NUMBERS.iter().zip(self.values) {
            if let Some(value) = value {
                *(number.field)(settings) = value;
            }
        }
    }
}

impl Args for NumberFlags {
    fn augment_args(command: Command) -> Command {
        let flags = PIPELINE_NUMBERS.iter().filter_map(|number| Some((number.flag?, number)));
        flags.fold(command, |command, (flag, number)| {
            let (unit, default) = (number.typed_unit(), number.default_shown());
            let argument = Arg::new(flag)
                .long(flag)
                .value_name(number.unit)
                .help(format!("{} ({unit}) [default: {default}]", number.meaning))
                .value_parser(value_parser!(f64))
                .allow_negative_numbers(true);
            command.arg(argument)
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for NumberFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let values = PIPELINE_NUMBERS.map(|number| matches.get_one(number.flag?).copied());
        Ok(Self { values })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
