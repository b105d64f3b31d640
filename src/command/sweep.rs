//! `resect sweep`: how the errors depend on one threshold.

use clap::{Args, ValueEnum};

use super::method_name::MethodName;
use super::study_args::StudyArguments;
use super::{Failure, print};
use crate::calibration::Method;
use crate::experiment::{Control, Parameter, Sweep, sweep};
use crate::export::study;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ParameterName {
    TauR,
    TauA,
    TauE,
    TauS,
    TauL,
    Rate,
}

impl From<ParameterName> for Parameter {
    fn from(name: ParameterName) -> Self {
        match name {
            ParameterName::TauR => Self::TauR,
            ParameterName::TauA => Self::TauA,
            ParameterName::TauE => Self::TauE,
            ParameterName::TauS => Self::TauS,
            ParameterName::TauL => Self::TauL,
            ParameterName::Rate => Self::Rate,
        }
    }
}

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArguments,
    /// What to vary
    #[arg(long, value_enum)]
    parameter: ParameterName,
    /// First value, in the unit of the setting
    #[arg(long)]
    from: f64,
    /// Last value
    #[arg(long)]
    to: f64,
    /// Number of values, both ends included
    #[arg(long, default_value_t = 11)]
    steps: usize,
    /// Whose transforms judge: static-gcp where there are control points (as in the paper), else the dynamic method
    #[arg(long, value_enum, value_name = "METHOD")]
    reference: Option<MethodName>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.study.settings.settings()?;
    let splits = arguments.study.splits()?;
    let Arguments { parameter, from, to, steps, .. } = *arguments;
    let range = Sweep { parameter: parameter.into(), from, to, steps };
    range.check(&settings.pipeline).map_err(Failure::Usage)?;
    let deployments = arguments.study.deployments()?;
    let reference = arguments.reference.map(Method::from);
    let result = sweep(&deployments, &settings, &range, reference, splits, &Control::default())?;
    if arguments.study.json {
        print(&format!("{:#}\n", study::json(&result)))?;
    } else {
        print(&study::table(&result))?;
    }
    arguments.study.write(&result)
}
