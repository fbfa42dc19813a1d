//! The browser of whoever sits here.

use core::fmt::Write;
use std::env;
use std::path::Path;
use std::process::{Command, Stdio};

/// A file's address.
pub(super) fn address(file: &Path) -> Result<String, String> {
    let show = |error: std::io::Error| format!("{}: {error}", file.display());
    let whole = std::path::absolute(file).map_err(show)?;
    let mut out = String::from("file://");
    for byte in whole.to_string_lossy().replace('\\', "/").bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~:".contains(&byte) {
            out.push(char::from(byte));
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    Ok(out)
}

/// Opens an address where there is a screen and a program for it. Nobody waits for the browser, and its absence is no error: the address
/// is told.
pub(super) fn open(address: &str) {
    let screen = ["DISPLAY", "WAYLAND_DISPLAY"];
    let program: &[&str] = if cfg!(target_os = "macos") {
        &["open"]
    } else if cfg!(windows) {
        &["cmd", "/C", "start", ""]
    } else if screen.iter().any(|name| env::var_os(name).is_some()) {
        &["xdg-open"]
    } else {
        return;
    };
    let [name, arguments @ ..] = program else {
        return;
    };
    let mut command = Command::new(name);
    command.args(arguments).arg(address);
    let quiet = [Stdio::null(), Stdio::null(), Stdio::null()];
    let [input, output, error] = quiet;
    let _ = command.stdin(input).stdout(output).stderr(error).spawn();
}

#[cfg(test)]
mod tests {
    use super::address;
    use std::path::Path;

    #[test]
    fn an_address_has_no_blanks() {
        let told = address(Path::new("/a b/ü#?/report.html"));
        assert_eq!(
            told.as_deref(),
            Ok("file:///a%20b/%C3%BC%23%3F/report.html")
        );
    }
}
