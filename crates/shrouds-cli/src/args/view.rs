//! The arguments of `shrouds view`.

use clap::Args;

pub(crate) const VIEW_HELP: &str = "\
The page is served to this machine alone, on 127.0.0.1, and only under the address that is printed: it has a
token that is new every time. Who has the address can read every volume file that you can. Ctrl-C ends it.

Examples, the linked tori, and a file of yours:
  shrouds view demo:tori
  shrouds view organs.nii.gz";

#[derive(Args)]
pub(crate) struct TestBedArgs {
    /// What to open first: a volume file, or demo:NAME for a phantom (see `shrouds demo --help`)
    pub(crate) input: Option<String>,
    /// The port to listen on [default: one that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Print the address, but do not open it in a browser
    #[arg(long)]
    pub(crate) no_open: bool,
}
