//! Findings as HTML.

use maud::{Markup, html};

use crate::svg::hex;
use resect_core::deployment::Finding;
use resect_tools::palette;

pub fn badge(word: &str, ground: palette::Rgb, ink: palette::Rgb) -> Markup {
    html! {
        span.badge style={ "background:" (hex(ground)) ";color:" (hex(ink)) } { (word) }
    }
}

/// The most severe first, each with its severity in a word.
pub fn findings(findings: &[Finding]) -> Markup {
    use resect_core::deployment::Severity::{Note, Problem, Warning};
    html! {
        @if !findings.is_empty() {
            ul.findings {
                @for (level, word) in [(Problem, "problem"), (Warning, "warning"), (Note, "note")] {
                    @for finding in findings.iter().filter(|finding| finding.severity == level) {
                        li class=(word) { span.level { (word) } " " (finding) }
                    }
                }
            }
        }
    }
}
