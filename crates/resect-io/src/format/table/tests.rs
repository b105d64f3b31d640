use proptest::prelude::*;

use super::*;

const COLUMNS: [&str; 2] = ["b", "a"];

fn rows(text: &str) -> Result<Vec<(usize, [f64; 2])>, String> {
    match read_columns("x.csv", text, &COLUMNS) {
        Ok(rows) => Ok(rows.into_iter().map(|row| (row.line, row.values)).collect()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn columns_are_found_by_name_and_lines_counted_as_they_stand() {
    let expected = Ok(vec![(2, [2.0, 1.0]), (4, [4.5, -3.0])]);
    for text in [
        "a,b\n1,2\n\n-3,4.5\n",
        "\u{feff}a,b\r\n1,2\r\n\r\n-3,4.5",
        "A , \"B\"\n 1 , 2 \n   \n\"-3\",\"4.5\"\n",
        "a,note,b\n1,\"x, \"\"y\"\"\",2\n\n-3,,4.5\n",
        "a,b,note\r\n1,2,\r\n\r\n-3,4.5,läuft\r\n",
    ] {
        assert_eq!(rows(text), expected, "{text}");
    }
    assert_eq!(rows("\n\na,b\n1,2\n"), Ok(vec![(4, [2.0, 1.0])]));
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    for (text, expected) in [
        ("", "x.csv:1: no column `b`"),
        ("a,c\n", "x.csv:1: no column `b`; the header must name b, a"),
        ("a,b\n1,2\n1\n", "x.csv:3: 1 fields where the header has 2; the line may be cut short"),
        (
            "a,b\n1,2,3\n",
            "x.csv:2: 3 fields where the header has 2; a column of row numbers has no name",
        ),
        ("a,b\n1,2\n\n1,x\n", "x.csv:4: `x` in column `b` is not a number"),
        ("a,b\n1,\"1,234\"\n", "x.csv:2: `1,234` in column `b` is not a number"),
        ("a,b\n1,\"2\n", "x.csv:2: a quoted field runs over the end"),
        ("a,b\n1,\"2\"3\n", "x.csv:2: `3` stands behind a closing quote"),
        ("a,b\n1,\u{1b}[31m2\n", "x.csv:2: `\\u{1b}[31m2` in column"),
    ] {
        let error = rows(text).expect_err(text);
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
        assert!(error.contains("; "), "no remedy in `{error}`");
    }
    let huge = format!("a,b\n1,{}\n", "x".repeat(500_000));
    assert!(rows(&huge).expect_err("no number").len() < 200);
}

#[test]
fn tables_of_other_programs_are_read() {
    let expected = Ok(vec![[2.5, 1.0], [4.5, -3.0]]);
    for text in [
        "a;b\n1;2,5\n-3;4,5\n",
        "a\tb\n1\t2.5\n-3\t4.5\n",
        "a|b\n1|2.5\n-3|4.5\n",
        "# a b\n1  2.5\n-3  4.5\n",
        "sep=;\na;b\n1;2,5\n-3;4,5\n",
        "# recorded by hand\n% second line\n\na,b\n1,2.5\n-3,4.5\n",
        "Project: tunnel, south\na,b\n1,2.5\n-3,4.5\n",
        "a,b\n1,2.5,\n-3,4.5,\n",
        ",a,b\n0,1,2.5\n1,-3,4.5\n",
    ] {
        let rows = rows(text).map(|rows| rows.into_iter().map(|(_, values)| values).collect());
        assert_eq!(rows, expected, "{text}");
    }
    assert_eq!(rows("a,b\n\"1,234,567.5\",2\n"), Ok(vec![(2, [2.0, 1_234_567.5])]));
    let missing = rows("a,b\n1,-\nN/A,2\n,---\n").expect("readable");
    assert!(missing[0].1[0].is_nan() && missing[1].1[1].is_nan());
    assert_eq!(missing.len(), 3);
}

#[test]
fn rows_that_are_not_valid_are_counted_unless_they_are_most() {
    let read = |text: &[u8]| {
        let mut values = Vec::new();
        let skipped = for_each_row("x.csv", text, &COLUMNS, &Progress::default(), |row| {
            values.push(row.values);
            if row.values[0] == 9.0 { Err("is nine".to_owned()) } else { Ok(()) }
        });
        skipped.map(|skipped| (values.len(), skipped)).map_err(|error| error.to_string())
    };
    let first = Some((3, "1 fields where the header has 2; the line may be cut short".to_owned()));
    let expected = SkippedRows { count: 2, first };
    assert_eq!(read(b"a,b\n1,2\n3\n5,9\n5,6\n7,8\n"), Ok((4, expected)));
    let error = read(b"a,b\n1,x\n2,y\n3,4\n").expect_err("most");
    assert_eq!(
        error,
        "x.csv:2: `x` in column `b` is not a number; 2 rows of 3 are like that; correct or delete the line"
    );
    // Latin-1 is read; a number it is not.
    assert!(read(b"a,b,\xb0C\n1,2,\xfc\n").is_ok());
}

#[test]
fn reading_stops_when_it_is_cancelled_and_counts_every_byte() {
    let text = "a,b\n".to_owned() + &"1.5,2.5\n".repeat(200_000);
    let progress = Progress::default();
    let mut taken = 0;
    let cancelled = for_each_row("x", text.as_bytes(), &COLUMNS, &progress, |_| {
        taken += 1;
        progress.cancel();
        Ok(())
    });
    assert!(matches!(cancelled, Err(OpenError::Cancelled)));
    assert!(taken < 100_000, "{taken}");
    let progress = Progress::default();
    for_each_row("x", text.as_bytes(), &COLUMNS, &progress, |_| Ok(())).expect("plain");
    assert_eq!(progress.done(), text.len() as u64);
}

/// Numbers in various formats, and near misses.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<f64>().prop_map(|value| value.to_string()),
        any::<f64>().prop_map(|value| format!("{value:e}")),
        (-1e9..1e10f64).prop_map(|value| format!("{value:.8}")),
        "[+-]?[0-9]{0,25}[.]?[0-9]{0,25}(e[+-]?[0-9]{0,3})?",
        "[ +.0-9a-finty\"-]{0,8}",
    ]
}

proptest! {
    /// The fast path and the general one agree with the standard library.
    #[test]
    fn numbers_are_those_of_the_standard_library(a in number(), b in number()) {
        let text = format!("a,b\n{a},{b}\n");
        let wanted = (fields(&a, ','), fields(&b, ','));
        let parsed = match wanted {
            (Ok(a), Ok(b)) if a.len() == 1 && b.len() == 1 => {
                a[0].parse::<f64>().ok().zip(b[0].parse::<f64>().ok())
            }
            _ => None,
        };
        let blank = format!("{a},{b}").trim().is_empty();
        let bits = |row: &[f64; 2]| row.map(f64::to_bits);
        match (rows(&text), parsed) {
            (Ok(rows), Some((a, b))) => {
                // All NaN are equal here.
                let same = rows[0].1.iter().zip([b, a]).all(|(x, y)| x.is_nan() && y.is_nan() || x.to_bits() == y.to_bits());
                prop_assert!(same, "{text}: {:?}", bits(&rows[0].1));
            }
            (Ok(rows), None) => {
                let is_missing = rows.iter().any(|row| row.1.iter().any(|value| value.is_nan()));
                prop_assert!(blank && rows.is_empty() || is_missing, "{text} was read");
            }
            (Err(error), parsed) => prop_assert!(parsed.is_none(), "{error}"),
        }
    }
}
