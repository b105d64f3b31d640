//! Corrections of the data in the deployment's pane. Each line shows the present value. A value that differs from the files has a mark,
//! shows the files' value, and can be reset.

mod files;
mod times;

use egui::RichText;
use resect_core::network::{Number, Pair, PerPair, PerStation};

use crate::app::model::{Commands, DeploymentCommand, OpenDeployment};
use crate::app::state::State;
use crate::app::state::corrections::{effective, exchanged, take_unfold};
use crate::app::theme;
use crate::app::words;
use resect_core::deployment::{
    AzimuthSense, Deployment, Overrides, PrismConstants, Severity, as_numbered,
};
use resect_io::override_changes::extras_changes;
use resect_io::source::Extras;

pub fn ui(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    let Some(extras) = state.extras() else { return };
    let count = extras_changes(&Extras::default(), extras, &open.deployment.as_read).len();
    let title =
        if count == 0 { "Corrections".to_owned() } else { format!("Corrections ({count})") };
    let dark = ui.visuals().dark_mode;
    let title = RichText::new(title).strong();
    let title = if count == 0 { title } else { title.color(mark_colour(dark)) };
    let unfold = take_unfold(ui.ctx());
    let header =
        egui::CollapsingHeader::new(title).id_salt("put right").open(unfold.then_some(true));
    let header = header.show(ui, |ui| {
        let mut changed = extras.clone();
        let shown = ShownCorrections { open, extras, now: effective(extras, &open.deployment) };
        shown.constants(ui, &mut changed);
        shown.distances(ui, &mut changed);
        shown.stations(ui, &mut changed);
        shown.azimuth(ui, &mut changed);
        shown.times(ui, &mut changed);
        shown.masks(ui, &mut changed);
        shown.prism_changes(ui, &mut changed);
        shown.files(ui, &mut changed, commands);
        ui.add_space(4.0);
        shown.keep(ui, commands);
        if changed != *extras {
            commands.push(DeploymentCommand::Correct(changed).into());
        }
    });
    if unfold {
        header.header_response.scroll_to_me(Some(egui::Align::TOP));
    }
    header.header_response.on_hover_text(
        "Corrects wrong or missing values of the files: prism constant, inter-prism distances, station numbers, sense of \
         azimuth, times, files",
    );
}

/// Data that the lines show.
struct ShownCorrections<'a> {
    open: &'a OpenDeployment,
    /// The user's corrections.
    extras: &'a Extras,
    /// The user's corrections, completed from the files.
    now: Overrides,
}

fn mark_colour(dark: bool) -> egui::Color32 {
    theme::severity(Severity::Warning, dark).0
}

/// Shows the name of a line, with a mark and the files' value `as_read` if they differ; returns true if the user resets the value.
fn name(ui: &mut egui::Ui, name: &str, as_read: Option<String>) -> bool {
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        let Some(as_read) = as_read else {
            words::explain_text(ui.label(name), name);
            return false;
        };
        let colour = mark_colour(ui.visuals().dark_mode);
        let (dot, _) = ui.allocate_exact_size(egui::vec2(8.0, 12.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 3.5, colour);
        let as_read = format!("As read: {as_read}");
        let label = ui.label(RichText::new(name).color(colour)).on_hover_text(&as_read);
        words::explain_text(label, name);
        let button = ui.small_button("reset").on_hover_text(as_read);
        let label = format!("Reset: {name}");
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
        button.clicked()
    })
    .inner
}

fn number(ui: &mut egui::Ui, label: &str, value: &mut f64, decimals: usize, unit: &str) -> bool {
    typed(ui, (label, unit), value, |field| field.fixed_decimals(decimals))
}

/// A number field that takes effect once the value is entered, because the data are then read again.
fn typed(
    ui: &mut egui::Ui,
    (label, unit): (&str, &str),
    value: &mut f64,
    dress: impl for<'a> FnOnce(egui::DragValue<'a>) -> egui::DragValue<'a>,
) -> bool {
    let any = f64::NEG_INFINITY..=f64::INFINITY;
    let field = super::number::field(ui, (label, unit), value, any, |ui, value, parse| {
        let field = dress(egui::DragValue::new(value)).suffix(unit).speed(0.0);
        ui.add(field.update_while_editing(false).custom_parser(parse))
    });
    let response = field.accessible_name(label);
    let changed = response.changed();
    response.on_hover_text(format!("{label}: click to type"));
    changed
}

impl ShownCorrections<'_> {
    fn deployment(&self) -> &Deployment {
        &self.open.deployment
    }

    fn constants(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let own = self.extras.corrections.prism_constant_m.as_ref();
        let read = self.deployment().as_read.prism_constant_m.clone().unwrap_or_default();
        if name(ui, "Prism constant", own.map(|_| read.in_words())) {
            changed.corrections.prism_constant_m = None;
        }
        let now = self.now.prism_constant_m.clone().unwrap_or_default();
        let each = now.each_m(self.deployment().tracks.len());
        let each_id = ui.scope_id().with(("a constant each", self.open.id));
        let mut apart = matches!(now, PrismConstants::Each(_))
            || ui.data(|data| data.get_temp::<bool>(each_id)).unwrap_or(false);
        ui.horizontal_wrapped(|ui| {
            let shown = if apart { each.as_slice() } else { &each.as_slice()[..1] };
            for (station, constant_m) in shown.iter().enumerate() {
                let mut mm = constant_m * 1e3;
                let label = match apart {
                    true => format!("Prism constant of station {}", station + 1),
                    false => "Prism constant of all stations".to_owned(),
                };
                if number(ui, &label, &mut mm, 1, " mm") {
                    let mut each = each.clone();
                    each[station] = mm / 1e3;
                    changed.corrections.prism_constant_m = Some(match apart {
                        true => PrismConstants::Each(each),
                        false => PrismConstants::All(mm / 1e3),
                    });
                }
            }
            let switch = ui.checkbox(&mut apart, "each its own");
            if switch.on_hover_text("A prism constant for each station").changed() {
                ui.data_mut(|data| data.insert_temp(each_id, apart));
                if !apart {
                    changed.corrections.prism_constant_m = Some(PrismConstants::All(each[0]));
                }
            }
        });
        let contain = self.now.ranges_include_prism_constant;
        let mut include = contain
            .unwrap_or_else(|| self.deployment().tracks.iter().all(|t| t.prism_constant_m == 0.0));
        let text = "the tracks' ranges contain it";
        let switch = ui.checkbox(&mut include, text);
        if switch.on_hover_text("If set, it is added to control points and rig only").changed() {
            changed.corrections.ranges_include_prism_constant = Some(include);
        }
    }

    fn distances(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let own = self.extras.corrections.inter_prism_m.as_ref();
        let read = self.deployment().as_read.inter_prism_m.as_ref();
        let as_read = own.map(|_| match read {
            Some(all) => all.map(|m| format!("{m:.4}")).as_slice().join(", ") + " m",
            None => "not known".to_owned(),
        });
        if name(ui, "Inter-prism distances", as_read) {
            changed.corrections.inter_prism_m = None;
        }
        distance_fields(ui, self.open, self.now.inter_prism_m.clone(), changed);
    }

    fn stations(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let own = self.extras.corrections.stations.as_ref();
        let in_words =
            |numbers: &PerStation<i64>| numbers.map(ToString::to_string).as_slice().join(", ");
        let stations = self.deployment().tracks.len();
        let usual = as_numbered(stations);
        let read = self.deployment().as_read.stations.as_ref().unwrap_or(&usual);
        let now = self.now.stations.as_ref().unwrap_or(&usual);
        if name(ui, "Station numbers", own.map(|_| in_words(read))) {
            changed.corrections.masked.clone_from(&self.now.masked);
            changed.corrections.renumber(now, read.clone());
        }
        ui.label(format!("Stations {} are {} of the files", in_words(&usual), in_words(now)));
        ui.horizontal_wrapped(|ui| {
            ui.label("Exchange");
            for [a, b] in Pair::among(stations).map(Pair::indices) {
                let button = ui.button(format!("{} and {}", a + 1, b + 1));
                let label = format!("Exchange stations {} and {}", a + 1, b + 1);
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
                if button.clicked() {
                    *changed = exchanged(self.extras, self.deployment(), [a, b]);
                }
            }
        });
    }

    fn azimuth(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let own = self.extras.corrections.azimuth;
        let read = self.deployment().as_read.azimuth.unwrap_or_default();
        if name(ui, "Azimuth turns", own.map(|_| read.title().to_owned())) {
            changed.corrections.azimuth = None;
        }
        let mut sense = self.now.azimuth.unwrap_or_default();
        ui.horizontal_wrapped(|ui| {
            for choice in AzimuthSense::ALL {
                ui.radio_value(&mut sense, choice, choice.title())
                    .on_hover_text("Direction of increasing azimuth in the files, seen from above");
            }
        });
        if sense != self.now.azimuth.unwrap_or_default() {
            changed.corrections.azimuth = Some(sense);
        }
    }

    /// Offers to save the corrections.
    fn keep(&self, ui: &mut egui::Ui, commands: &mut Commands) {
        let any = !self.extras.is_empty();
        let in_folder = self.open.source.as_ref().is_some_and(|source| source.path().is_some());
        ui.horizontal_wrapped(|ui| {
            let write =
                ui.add_enabled(any && in_folder, egui::Button::new("Write to deployment.toml…"));
            let why_not =
                if in_folder { "No corrections" } else { "A built-in sample has no folder" };
            let hint =
                "Stores the corrections in the folder. Until then only the session has them.";
            if write.on_hover_text(hint).on_disabled_hover_text(why_not).clicked() {
                commands.push(DeploymentCommand::WriteDeploymentToml.into());
            }
            let all = ui.add_enabled(any, egui::Button::new("Reset all"));
            if all.on_hover_text("Use the values of the files").clicked() {
                commands.push(DeploymentCommand::Correct(Extras::default()).into());
            }
        });
    }
}

/// Fields for the distances, also if none is known; they take effect once all are entered.
pub fn distance_fields(
    ui: &mut egui::Ui,
    open: &OpenDeployment,
    known_m: Option<PerPair<f64>>,
    changed: &mut Extras,
) {
    // The distances entered so far, if none are known.
    let typed_id = egui::Id::unique("distances typed").with(open.id);
    let so_far: Option<PerPair<f64>> = ui.data(|data| data.get_temp(typed_id)).unwrap_or_default();
    let of_own_prisms = || PerPair::repeat(Pair::count(open.deployment.tracks.len()), 0.0);
    let mut all_m = known_m.or(so_far).unwrap_or_else(of_own_prisms);
    let mut entered = false;
    ui.horizontal_wrapped(|ui| {
        for (pair, distance_m) in all_m.iter_mut().enumerate() {
            let label = format!("Distance of prisms {}", Pair::at(pair));
            // The name is inside the field, so that a line break cannot separate it from the number.
            entered |= typed(ui, (&label, " m"), distance_m, |field| {
                field.prefix(format!("{}:  ", Pair::at(pair))).fixed_decimals(4)
            });
        }
    });
    if entered && all_m.iter().all(|m| *m > 0.0) {
        changed.corrections.inter_prism_m = Some(all_m);
    } else if entered {
        ui.data_mut(|data| data.insert_temp(typed_id, Some(all_m)));
    }
}
