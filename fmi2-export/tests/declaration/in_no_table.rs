#[fmi2_export::interface]
mod variables {
    #[outputs]
    pub struct Output {
        /// Position
        pub position: f64,
    }

    /// A group that nothing uses.
    pub struct Servo {
        /// Bandwidth
        pub bandwidth: f64,
    }

    /// What it does
    pub enum State {
        /// Nothing
        Idle,
    }
}

fn main() {}
