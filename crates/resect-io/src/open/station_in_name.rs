//! Station numbers in file names.

/// Returns the last number of a file's name, and the path with `#` in place of it.
pub fn station_in_name(file: &str) -> Option<(String, i64)> {
    let folder = file.rfind(['/', '\\']).map_or(0, |at| at + 1);
    let end = folder + file[folder..].rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = file[..end].rfind(|c: char| !c.is_ascii_digit()).map_or(0, |at| at + 1);
    // The character before the digits may be longer than a byte.
    let start = (start..end).find(|at| file.is_char_boundary(*at))?;
    let number = file[start..end].parse().ok()?;
    Some((format!("{}#{}", &file[..start], &file[end..]), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_number_of_a_name_is_the_station() {
        for (name, expected) in [
            ("total_stations/trimble1.csv", Some(("total_stations/trimble#.csv", 1))),
            ("f-2-1-1-1-6-0-L_3.csv", Some(("f-2-1-1-1-6-0-L_#.csv", 3))),
            ("2022/x.csv", None),
            ("été2", Some(("été#", 2))),
            ("3", Some(("#", 3))),
        ] {
            let found = station_in_name(name);
            assert_eq!(found.as_ref().map(|(p, n)| (p.as_str(), *n)), expected, "{name}");
        }
    }
}
