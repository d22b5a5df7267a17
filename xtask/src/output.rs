//! Lines on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

/// As `println!`, but a reader that has closed the pipe (`| head`) ends the program quietly.
macro_rules! say {
    ($($arg:tt)*) => { $crate::output::line(format_args!($($arg)*)) };
}

pub(crate) fn line(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => std::process::exit(0),
        // Nowhere is left to report to.
        _ => {}
    }
}
