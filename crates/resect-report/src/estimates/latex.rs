//! The errors of a judgement as a LaTeX table.

use std::fmt::Write;

use resect_tools::estimates::EstimatesJudgement;

use super::rows::{Angles, ErrorRow, rows};

/// Formats the rows of the terminal's table with a column for each estimate (package `booktabs`).
pub fn latex(judgement: &EstimatesJudgement) -> String {
    let columns = "r".repeat(judgement.judged.len());
    let mut text = format!("\\begin{{tabular}}{{l{columns}}}\n\\toprule\n");
    let names: Vec<String> =
        judgement.judged.iter().map(|one| escaped(&one.estimate.name)).collect();
    _ = writeln!(text, " & {} \\\\\n\\midrule", names.join(" & "));
    for ErrorRow { label, cells, .. } in rows(judgement, Angles::DEGREES) {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        _ = writeln!(text, "{} & {} \\\\", escaped(label.trim()), cells.join(" & "));
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}

/// Returns text with LaTeX's special characters escaped, and symbols as commands that every font has.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(character);
            }
            '\\' => escaped += "\\textbackslash{}",
            '~' => escaped += "\\textasciitilde{}",
            '^' => escaped += "\\textasciicircum{}",
            '±' => escaped += "$\\pm$",
            'σ' => escaped += "$\\sigma$",
            '°' => escaped += "$^\\circ$",
            '²' => escaped += "$^2$",
            '–' => escaped += "--",
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(escaped("a_b & 5 %"), "a\\_b \\& 5 \\%");
        assert_eq!(escaped("+1.0 ± 0.2 °"), "+1.0 $\\pm$ 0.2 $^\\circ$");
    }
}
