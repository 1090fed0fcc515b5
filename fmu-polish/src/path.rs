//! The path: CL data from a file, the path of the ball center made of them, and the feed along it.

pub mod built_in;
pub mod centre_path;
mod cl_checks;
pub mod cl_data;
pub mod cl_file;
mod cl_statement;
pub mod feed;
