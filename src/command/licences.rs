//! `resect licences`: the licences of the program and of the packages in it.

use super::{Failure, print};

pub fn run() -> Result<(), Failure> {
    print(&crate::licences::text())?;
    Ok(())
}
