//! `resect explain`: the glossary of the window.

use clap::Args;

use super::{Failure, print};
use resect_report::glossary;
use resect_report::glossary::Term;

/// Characters in a line.
const WIDTH: usize = 96;

#[derive(Args)]
pub struct ExplainArguments {
    /// Term to explain, such as tau-s, T12 or "mirror ambiguity"; all terms if none
    word: Vec<String>,
}

pub fn run(arguments: &ExplainArguments) -> Result<(), Failure> {
    let query = arguments.word.join(" ");
    // An exact name selects that term alone, and not each term that mentions it.
    let found =
        glossary::find(&query).map_or_else(|| glossary::matching(&query), |term| vec![term]);
    if found.is_empty() {
        let line = format!("no explained word contains \"{query}\"; `resect explain` lists all");
        return Err(Failure::Usage(line));
    }
    let texts: Vec<String> = found.into_iter().map(entry).collect();
    print(&texts.join("\n"))?;
    Ok(())
}

fn entry(term: &Term) -> String {
    let mut text = format!("{}\n", glossary::title(term));
    let source = term.source();
    for line in std::iter::once(term.means).chain(source.as_deref()) {
        let mut column = usize::MAX;
        for word in line.split_whitespace() {
            let length = word.chars().count();
            if column.saturating_add(1 + length) > WIDTH {
                text += if column == usize::MAX { "   " } else { "\n   " };
                column = 3;
            }
            text.push(' ');
            text += word;
            column += 1 + length;
        }
        text.push('\n');
    }
    text
}
