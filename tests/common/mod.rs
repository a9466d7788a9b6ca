//! What several tests share.

#![allow(dead_code, reason = "no single test program uses all of it")]

pub mod command;
