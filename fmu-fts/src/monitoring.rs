//! Monitors of the closed loop: what was asked of the arm against what its encoder says.

pub mod cycle;
pub mod drive;
pub mod feed;
pub mod growth;
pub mod life;
pub mod numbers;
pub mod watch;
