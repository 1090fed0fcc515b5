//! x
use crate::workspace::Workspace;
/// x
pub fn run(_w: &Workspace) -> anyhow::Result<bool> {
    Ok(true)
}
