//! One page, served to browsers of this machine by HTTP.

mod request;
mod server;

pub(super) use server::Server;
