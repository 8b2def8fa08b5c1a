//! `shrouds view`: the test bed in the browser.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use serde_json::{Value, json};
use shrouds::volume::phantom::named;
use shrouds_io::volume_format;
use shrouds_view::server::Server;

use crate::args::TestBedArgs;
use crate::console::print;
use crate::failure::Failure;
use crate::view::Host;

/// What an input that is no file begins with.
const PHANTOM: &str = "demo:";

pub(crate) fn run(args: &TestBedArgs, threads: Option<u16>) -> Result<(), Failure> {
    let input = args.input.as_deref().map_or(Ok(Value::Null), source)?;
    let server = Server::bind(args.port)?;
    let address = server.address();
    print(&address)?;
    if !args.no_open {
        open(&address);
    }
    let threads = threads.map_or(0, usize::from);
    Ok(server.run(Arc::new(Host { input, threads, lane: Arc::default() }))?)
}

/// The input as the page asks for it; one that cannot be is refused at once.
fn source(input: &str) -> Result<Value, Failure> {
    if let Some(name) = input.strip_prefix(PHANTOM) {
        named(name, 1)?;
        return Ok(json!({ "demo": name }));
    }
    volume_format(input)?;
    let path = std::path::absolute(Path::new(input)).ok().filter(|path| path.exists());
    match path.as_deref().and_then(Path::to_str) {
        Some(path) => Ok(json!({ "path": path })),
        None => Err(Failure::Undone(format!("{input}: there is no such file"))),
    }
}

/// Opens the address in a browser, where the system knows how; the address was printed in any case.
fn open(address: &str) {
    let (program, first): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(first).arg(address);
    let _ = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
}
