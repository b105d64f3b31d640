//! Messages of findings: text, and angles that are rendered in the unit of the reader.

use std::fmt;

use super::MessageAngle;
use super::printable::printable;

/// A message as a list of text and angles. `Display` writes each angle in the unit that its finding chose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Message(Vec<MessagePart>);

#[derive(Clone, Debug, PartialEq)]
enum MessagePart {
    Text(String),
    Angle(MessageAngle),
}

impl Message {
    /// Appends text; control characters become escape codes.
    #[must_use]
    pub fn text(mut self, text: impl AsRef<str>) -> Self {
        self.0.push(MessagePart::Text(printable(text.as_ref())));
        self
    }

    /// Appends an angle.
    #[must_use]
    pub fn angle(mut self, angle: MessageAngle) -> Self {
        self.0.push(MessagePart::Angle(angle));
        self
    }

    /// Appends another message.
    #[must_use]
    pub fn message(mut self, other: impl Into<Message>) -> Self {
        self.0.extend(other.into().0);
        self
    }

    /// Renders the message; `render_angle` renders each angle.
    pub fn render(&self, render_angle: impl Fn(&MessageAngle) -> String) -> String {
        let render_part = |part: &MessagePart| match part {
            MessagePart::Text(text) => text.clone(),
            MessagePart::Angle(angle) => render_angle(angle),
        };
        self.0.iter().map(render_part).collect()
    }
}

impl From<&str> for Message {
    fn from(text: &str) -> Self {
        Self::default().text(text)
    }
}

impl From<String> for Message {
    fn from(text: String) -> Self {
        Self::default().text(text)
    }
}

impl From<MessageAngle> for Message {
    fn from(angle: MessageAngle) -> Self {
        Self::default().angle(angle)
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(MessageAngle::to_string))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::AngleFormat;

    #[test]
    fn angles_are_rendered_in_the_unit_of_the_reader() {
        let turned = MessageAngle::signed(5e-4, AngleFormat::Milliradians, 2);
        let message = Message::from("turned by ").angle(turned).text(" at\r once");
        assert_eq!(message.to_string(), "turned by +0.50 mrad at\\r once");
        let in_degrees = |angle: &MessageAngle| format!("{:.3}°", angle.value_rad.to_degrees());
        assert_eq!(message.render(in_degrees), "turned by 0.029° at\\r once");
    }
}
