//! The table of all actions, and its search.

use super::{Action, edit, file, help, remedies, settings, time, view};
use crate::app::state::State;

/// Returns all actions of a state, in menu order.
pub fn all(state: &State) -> Vec<Action> {
    let mut actions = file::actions(state);
    actions.extend(edit::actions(state));
    actions.extend(remedies::actions(state));
    actions.extend(time::actions(state));
    actions.extend(view::actions(state));
    actions.extend(file::exports(state));
    actions.extend(help::actions());
    actions.extend(settings::actions(state));
    actions
}

/// Returns the available actions that match a query, the best first. Every word of it is in the menu's title, the section, the name, the
/// hint or the further words.
pub fn matching(actions: &[Action], query: &str) -> Vec<Action> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let mut found: Vec<(usize, &Action)> = actions
        .iter()
        .filter(|action| action.command.is_some())
        .filter_map(|action| {
            let name = action.name.to_lowercase();
            let all = format!(
                "{} {} {name} {} {}",
                action.menu.title().to_lowercase(),
                action.section.to_lowercase(),
                action.hint.to_lowercase(),
                action.also
            );
            // Cost by the word's position: start of the name, start of a word in it, anywhere in it, elsewhere.
            let cost = |word: &String| match name.find(word.as_str()) {
                Some(0) => Some(0),
                Some(_) if name.contains(&format!(" {word}")) => Some(1),
                Some(_) => Some(2),
                None => all.contains(word.as_str()).then_some(5),
            };
            words.iter().map(cost).sum::<Option<usize>>().map(|cost| (cost, action))
        })
        .collect();
    found.sort_by_key(|(cost, _)| *cost);
    found.into_iter().map(|(_, action)| action.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::actions::Menu;

    fn state() -> State {
        State::new(egui::Context::default())
    }

    #[test]
    fn numbers_of_the_pipeline_are_found_by_their_names() {
        let names = |query: &str| -> Vec<String> {
            matching(&all(&state()), query).into_iter().map(|action| action.name).collect()
        };
        let thresholds = names("tau");
        assert_eq!(thresholds.len(), 5, "{thresholds:?}");
        assert_eq!(thresholds[0], "τ_r, range rate: 2 m/s");
        assert_eq!(names("tau_s").len(), 1);
    }

    #[test]
    fn no_two_actions_share_keys_or_a_name() {
        let actions = all(&state());
        for (index, one) in actions.iter().enumerate() {
            for other in &actions[index + 1..] {
                assert!(
                    one.shortcut.is_none() || one.shortcut != other.shortcut,
                    "{} and {}",
                    one.name,
                    other.name
                );
                assert!(one.menu != other.menu || one.name != other.name, "{}", one.name);
            }
        }
    }

    #[test]
    fn the_actions_of_a_section_follow_each_other() {
        let actions = all(&state());
        let mut seen: Vec<(Menu, &str)> = Vec::new();
        for action in &actions {
            let place = (action.menu, action.section);
            if seen.last() != Some(&place) {
                assert!(!seen.contains(&place), "{place:?} comes twice");
                seen.push(place);
            }
        }
    }

    #[test]
    fn a_query_finds_by_words_in_any_order_and_puts_the_name_first() {
        let actions = all(&state());
        let found = matching(&actions, "folder open");
        assert_eq!(found[0].name, "Open folder…");
        let found = matching(&actions, "fit");
        assert_eq!(found[0].name, "Fit");
        assert_eq!(matching(&actions, "light")[0].name, "Theme: light");
        assert_eq!(matching(&actions, "gon")[0].name, "Angles in gon");
        assert!(matching(&actions, "no such thing").is_empty());
        for action in actions.iter().filter(|action| action.command.is_some()) {
            let words = format!("{} {} {}", action.menu.title(), action.name, action.hint);
            let found = matching(&actions, &words.to_uppercase());
            assert!(found.iter().any(|found| found.name == action.name), "{words}");
        }
        // An unavailable action is not found.
        assert!(matching(&actions, "undo").is_empty());
        assert_eq!(
            matching(&actions, "").len(),
            actions.iter().filter(|a| a.command.is_some()).count()
        );
    }
}
