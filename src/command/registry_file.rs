//! The entries of the program in the registry of Windows, as the text that `reg import` reads.

/// First line of a registry file.
const HEAD: &str = "Windows Registry Editor Version 5.00";
/// The type of sessions. Windows knows a file type by its last extension, so that sessions are `.toml` files which resect can open too.
const FILE_TYPE: &str = r"HKEY_CURRENT_USER\Software\Classes\resect.session";
/// Programs in "Open with" of `.toml` files.
const OPEN_WITH: &str = r"HKEY_CURRENT_USER\Software\Classes\.toml\OpenWithProgids";
/// Lets "Run" and `start` find the program without the search path.
const APP_PATH: &str =
    r"HKEY_CURRENT_USER\Software\Microsoft\Windows\CurrentVersion\App Paths\resect.exe";

/// Keys with the entries of the program, for people.
pub const KEYS: [&str; 3] = [FILE_TYPE, OPEN_WITH, APP_PATH];

/// Returns the registry file that adds the program at this path.
pub fn adding(program: &str) -> String {
    let program = program.replace('\\', r"\\");
    let lines = [
        format!("{HEAD}\n"),
        format!("[{FILE_TYPE}]\n@=\"resect session\"\n"),
        format!("[{FILE_TYPE}\\DefaultIcon]\n@=\"\\\"{program}\\\",0\"\n"),
        format!("[{FILE_TYPE}\\shell\\open\\command]\n@=\"\\\"{program}\\\" \\\"%1\\\"\"\n"),
        format!("[{OPEN_WITH}]\n\"resect.session\"=\"\"\n"),
        format!("[{APP_PATH}]\n@=\"{program}\"\n"),
    ];
    with_line_ends(&lines.join("\n"))
}

/// Returns the registry file that removes these entries, and nothing of other programs.
pub fn removing() -> String {
    let lines = [
        format!("{HEAD}\n"),
        format!("[-{FILE_TYPE}]\n"),
        format!("[{OPEN_WITH}]\n\"resect.session\"=-\n"),
        format!("[-{APP_PATH}]\n"),
    ];
    with_line_ends(&lines.join("\n"))
}

fn with_line_ends(text: &str) -> String {
    text.replace('\n', "\r\n")
}

/// Returns a registry file as UTF-16 with a byte-order mark, which `reg import` needs for names outside ASCII.
pub fn encoded(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_quoted_for_the_file_and_for_the_command() {
        let text = adding(r"C:\für mich\resect.exe");
        let command = r#"@="\"C:\\für mich\\resect.exe\" \"%1\"""#;
        assert!(text.contains(&format!("shell\\open\\command]\r\n{command}\r\n")), "{text}");
        assert!(text.starts_with("Windows Registry Editor Version 5.00\r\n\r\n["), "{text}");
        assert_eq!(encoded("aü"), [0xff, 0xfe, b'a', 0, 0xfc, 0]);
    }

    #[test]
    fn all_that_is_added_is_removed() {
        let (added, removed) = (adding("resect.exe"), removing());
        for key in KEYS {
            assert!(added.contains(&format!("\r\n[{key}]\r\n")), "{added}");
        }
        for key in [FILE_TYPE, APP_PATH] {
            assert!(removed.contains(&format!("[-{key}]\r\n")), "{removed}");
        }
        let of_toml = format!("[{OPEN_WITH}]\r\n\"resect.session\"=-\r\n");
        assert!(removed.contains(&of_toml), "{removed}");
    }
}
