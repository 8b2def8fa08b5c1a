//! `shrouds view`: the server, as a page and as those it must not let in see it.

mod client;
mod files;
mod guard;
mod hostile;
mod look;
mod several;
mod work;
