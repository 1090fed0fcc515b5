#[fmi2_export::interface]
mod variables {
    #[inputs]
    pub struct Input {
        pub position: f64,
        force: f64,
    }

    /// What it does
    pub enum Mode {
        Off,
    }

    #[parameters]
    pub struct Parameters {
        /// Mode
        pub mode: Mode,
    }
}

fn main() {}
