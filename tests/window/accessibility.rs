//! Names and values for screen readers, and the way of the keyboard to the numbers.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{LayoutPreset, Pane, WorkspaceCommand};

use crate::harness::{LARGE, Window, press, send, window};

/// Roles that a user can operate.
const CONTROLS: [Role; 8] = [
    Role::Button,
    Role::CheckBox,
    Role::RadioButton,
    Role::ComboBox,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
    Role::Link,
];

/// Returns a description of each control without a name, and of each number without a value.
fn nameless(harness: &Window) -> Vec<String> {
    let mut found = Vec::new();
    for node in harness.root().children_recursive() {
        let node = node.accesskit_node();
        if !CONTROLS.contains(&node.role()) {
            continue;
        }
        let name = node.label().or_else(|| node.value()).unwrap_or_default();
        let is_number = matches!(node.role(), Role::Slider | Role::SpinButton);
        if name.trim().is_empty() || (is_number && node.numeric_value().is_none()) {
            let place = node.bounding_box();
            found.push(format!("{:?} {name:?} at {place:?}", node.role()));
        }
    }
    found
}

#[test]
fn every_control_has_a_name_and_every_number_a_value() {
    let mut harness = window(LARGE, Theme::Dark);
    let controls = harness.root().children_recursive();
    let controls = controls.filter(|node| CONTROLS.contains(&node.accesskit_node().role()));
    assert!(controls.count() > 60, "the tree is not searched");
    for preset in LayoutPreset::ALL {
        send(&mut harness, WorkspaceCommand::UseLayout(preset));
        let found = nameless(&harness);
        assert!(found.is_empty(), "{preset:?}: {found:#?}");
    }
    for pane in Pane::ALL {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        let found = nameless(&harness);
        assert!(found.is_empty(), "{pane:?}: {found:#?}");
    }
}

#[test]
fn a_number_of_the_pipeline_is_at_most_five_tabs_from_its_pane() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Pipeline));
    harness.get_by_role_and_label(Role::Button, "Pipeline").focus();
    harness.run_steps(2);
    let mut way = Vec::new();
    for _ in 0..5 {
        press(&mut harness, Modifiers::NONE, Key::Tab);
        let focused = harness.root().children_recursive().find(egui_kittest::Node::is_focused);
        let node = focused.expect("something has the focus").accesskit_node();
        if matches!(node.role(), Role::Slider | Role::SpinButton) {
            return;
        }
        way.push(format!("{:?} {:?}", node.role(), node.label()));
    }
    panic!("no number among {way:#?}");
}
