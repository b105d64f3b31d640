//! Screenshot of the scene with its labels: the window's pixels, cropped to the pane.

use super::State;
use crate::app::model::PictureTo;

impl State {
    /// Prepares the frame for a requested picture; called before it is drawn. Some systems capture the frame after the
    /// requested one, so all frames are prepared until the picture arrives.
    pub fn begin_picture(&mut self) {
        self.scene.picturing |= self.scene.wanted_picture.is_some();
    }

    /// Requests the window's pixels within the scene's rectangle of this frame (points).
    pub fn take_picture(&mut self, ctx: &egui::Context, scene: Option<egui::Rect>) {
        let Some(to) = self.scene.wanted_picture.take() else { return };
        let Some(scene) = scene else {
            self.scene.picturing = false;
            self.toasts.error("the scene is not shown; bring its pane to the front");
            return;
        };
        let outbox = self.jobs.outbox();
        let pixels_per_point = ctx.pixels_per_point();
        ctx.request_screenshot(move |window| {
            let image = cut(&window, scene, pixels_per_point);
            outbox.put(move |state: &mut Self| state.take_pictured(to, image));
        });
    }

    pub(super) fn take_pictured(&mut self, to: PictureTo, image: Option<egui::ColorImage>) {
        self.scene.picturing = false;
        let Some(image) = image else {
            self.toasts.error("the scene is outside the window; make room for its pane");
            return;
        };
        match to {
            PictureTo::Clipboard => {
                self.jobs.ctx().copy_image(image);
                self.toasts.done("picture of the scene copied");
            }
            PictureTo::File => {
                let bytes = image.pixels.iter().flat_map(egui::Color32::to_srgba_unmultiplied);
                let [width, height] = image.size.map(|side| side as u32);
                if let Some(image) = image::RgbaImage::from_raw(width, height, bytes.collect()) {
                    self.save_picture(image);
                }
            }
        }
    }
}

/// Crops the picture to a rectangle of the window (points); `None` if they do not overlap.
fn cut(
    window: &egui::ColorImage,
    part: egui::Rect,
    pixels_per_point: f32,
) -> Option<egui::ColorImage> {
    let whole = egui::Rect::from_min_size(egui::Pos2::ZERO, window.size.map(|s| s as f32).into());
    let part = (part * pixels_per_point).intersect(whole);
    let [left, top] = [part.left().ceil(), part.top().ceil()].map(|side| side as usize);
    let [right, bottom] = [part.right().floor(), part.bottom().floor()].map(|side| side as usize);
    (right > left && bottom > top)
        .then(|| window.region_by_pixels([left, top], [right - left, bottom - top]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_scene_is_cut_out_and_only_what_is_there() {
        let pixels = (0..80).map(egui::Color32::from_gray).collect();
        let window = egui::ColorImage::new([10, 8], pixels);
        let part = |left, top, right, bottom| {
            egui::Rect::from_min_max(egui::pos2(left, top), egui::pos2(right, bottom))
        };
        let image = cut(&window, part(1.0, 1.0, 3.0, 2.5), 2.0).expect("inside");
        assert_eq!(image.size, [4, 3]);
        assert_eq!(image.pixels[0], egui::Color32::from_gray(22));
        assert_eq!(cut(&window, part(4.0, 3.0, 100.0, 100.0), 1.0).expect("half").size, [6, 5]);
        assert!(cut(&window, part(40.0, 3.0, 100.0, 100.0), 1.0).is_none());
    }
}
