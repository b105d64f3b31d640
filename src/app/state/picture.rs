//! A picture of a pane to a file or to the clipboard.

use super::State;
use crate::app::model::{PictureOrder, PictureTo};
use crate::app::pictures::pane_picture::PanePicture;
use resect_io::atomic;

impl State {
    /// Returns the picture that was asked for since the last call.
    pub fn take_wanted_picture(&mut self) -> Option<(PictureOrder, PictureTo)> {
        self.workspace.wanted_picture.take()
    }

    /// Saves or copies a picture.
    pub fn take_picture(
        &mut self,
        order: &PictureOrder,
        to: PictureTo,
        picture: Result<PanePicture, String>,
    ) {
        let pane = order.pane.title();
        match (picture, to) {
            (Err(why), _) => self.toasts.error(&why),
            (Ok(PanePicture::Pixels(image)), PictureTo::Clipboard) => {
                let size = [image.width() as usize, image.height() as usize];
                let image = egui::ColorImage::from_rgba_unmultiplied(size, image.as_raw());
                self.jobs.ctx().copy_image(image);
                self.toasts.done(format!("picture of {pane} copied, {} × {}", size[0], size[1]));
            }
            (Ok(PanePicture::Svg(svg)), PictureTo::Clipboard) => {
                self.jobs.ctx().copy_text(svg);
                self.toasts.done(format!("picture of {pane} copied as SVG text"));
            }
            (Ok(picture), PictureTo::File) => self.save_picture(order, picture),
        }
    }

    fn save_picture(&mut self, order: &PictureOrder, picture: PanePicture) {
        let extension = order.format.extension();
        let title = format!("Save the picture of {} ({})", order.pane.title(), order.format.name());
        let answer = self.ask_where(&title, extension);
        self.tell_when_done(move || {
            let path = answer.wait()?;
            if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case(extension)) {
                let file = path.display();
                return Some(Err(format!(
                    "{file}: not written; a name that ends in .{extension} is needed"
                )));
            }
            let written = picture
                .encoded()
                .and_then(|bytes| atomic::write(&path, bytes).map_err(|error| error.to_string()));
            Some(written.map(|()| format!("{} written", path.display())))
        });
    }
}
