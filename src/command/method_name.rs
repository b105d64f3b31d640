//! Methods as flags name them.

use clap::ValueEnum;

use crate::calibration::Method;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    TwoPoint,
    StaticGcp,
    DynamicGcp,
    InterPrism,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::TwoPoint => Self::TwoPoint,
            MethodName::StaticGcp => Self::StaticGcp,
            MethodName::DynamicGcp => Self::DynamicGcp,
            MethodName::InterPrism => Self::InterPrism,
        }
    }
}
