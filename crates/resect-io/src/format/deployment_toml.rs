//! `deployment.toml`: overrides of the user, which take precedence over anything recognised.

use toml_edit::{DocumentMut, Item};

use crate::error::OpenError;
use resect_core::deployment::Overrides;

pub fn read(file: &str, text: &str) -> Result<Overrides, OpenError> {
    let overrides: Overrides = parse_toml(file, text)?;
    overrides.check().map_err(|(what, remedy)| OpenError::file(file, what, remedy))?;
    Ok(overrides)
}

/// Parses any TOML file of the program; the error gives the line of the first mistake.
pub fn parse_toml<T: serde::de::DeserializeOwned>(file: &str, text: &str) -> Result<T, OpenError> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
        let what = error.message().lines().next().unwrap_or("not valid TOML");
        OpenError::line(file, line, what, "correct the line")
    })
}

/// Returns the text of a `deployment.toml` with the keys of `corrections` replaced or added.
///
/// Comments, order and all other keys are preserved.
pub fn merge(file: &str, text: &str, corrections: &Overrides) -> Result<String, OpenError> {
    // Invalid text must not be extended.
    read(file, text)?;
    let broken = |what: String| OpenError::file(file, what, "correct the file by hand");
    let mut merged: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| broken(error.message().to_owned()))?;
    let own = toml::to_string(corrections).map_err(|error| broken(error.to_string()))?;
    let own: DocumentMut =
        own.parse().map_err(|error: toml_edit::TomlError| broken(error.message().to_owned()))?;
    for (key, item) in own.iter() {
        let mut item = item.clone();
        match (&mut item, merged.get(key)) {
            // Preserves a comment after the value.
            (Item::Value(new), Some(Item::Value(old))) => *new.decor_mut() = old.decor().clone(),
            // Preserves the position of a table, and the comment above it.
            (Item::Table(new), Some(Item::Table(old))) => {
                *new.decor_mut() = old.decor().clone();
                new.set_position(old.position());
            }
            // Positions of tables in another document are meaningless here.
            (Item::Table(table), _) => table.set_position(None),
            (Item::ArrayOfTables(tables), _) => {
                tables.iter_mut().for_each(|table| table.set_position(None));
            }
            _ => {}
        }
        merged[key] = item;
    }
    let text = merged.to_string();
    // Checks that the result can be read.
    read(file, &text)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::{AzimuthSense, ColumnMapping, MaskedReading, PrismConstants};

    const OLD: &str = "# the drive in the rain\nname = \"day 2\"\n\nprism_constant_m = 0.01 # MT1000\ncontrol_points = [\"a.txt\"]\n\n\
                       # as logged\n[columns]\ntime = \"t\"\n";

    #[test]
    fn what_is_corrections_is_merged_and_everything_else_stays() {
        let corrections = Overrides {
            stations: Some([1, 3, 2].into()),
            azimuth: Some(AzimuthSense::CounterClockwise),
            prism_constant_m: Some(PrismConstants::All(-0.0345)),
            masked: Some(vec![
                MaskedReading { station: 2, time_s: 1657569100.123456 },
                MaskedReading { station: 3, time_s: 0.1 },
            ]),
            ..Overrides::default()
        };
        let text = merge("deployment.toml", OLD, &corrections).expect("valid");
        for kept in
            ["# the drive in the rain\nname = \"day 2\"", "# MT1000", "# as logged\n[columns]"]
        {
            assert!(text.contains(kept), "{kept} is gone from\n{text}");
        }
        let expected = corrections.over(read("deployment.toml", OLD).expect("valid"));
        assert_eq!(read("deployment.toml", &text).expect("own text"), expected, "{text}");
        let new = merge("deployment.toml", "", &expected).expect("valid");
        assert_eq!(read("deployment.toml", &new).expect("own text"), expected, "{new}");
        let other = ColumnMapping { time: "stamp".to_owned(), ..ColumnMapping::default() };
        let other = Overrides { columns: Some(other), ..Overrides::default() };
        let replaced = merge("deployment.toml", OLD, &other).expect("valid");
        assert!(replaced.contains("# as logged\n[columns]\ntime = \"stamp\""), "{replaced}");
        // A second merge changes nothing.
        assert_eq!(merge("deployment.toml", &text, &expected).expect("valid"), text);
    }

    #[test]
    fn nothing_is_built_upon_what_is_broken_and_nothing_broken_is_written() {
        let error = merge("deployment.toml", "name = \n", &Overrides::default());
        assert!(error.expect_err("broken").to_string().starts_with("deployment.toml:1: "));
        let impossible =
            Overrides { inter_prism_m: Some([f64::NAN, 1.0, 1.0].into()), ..Overrides::default() };
        let error = merge("deployment.toml", OLD, &impossible).expect_err("no number");
        assert!(error.to_string().contains("inter_prism_m is [NaN"), "{error}");
    }
}
