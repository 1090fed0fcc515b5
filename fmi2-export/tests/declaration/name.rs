#[fmi2_export::interface]
mod variables {
    #[inputs]
    pub struct Input {
        /// Taken
        #[var(name = "axis1.position")]
        pub position: f64,
        #[var(name = "axis")]
        pub axis: [Axis; 2],
        /// No variable
        #[var(hidden, start = 0.0, name = "memory")]
        pub memory: f64,
    }

    /// One axis
    pub struct Axis {
        /// Position
        pub position: f64,
        /// Speed
        #[var(name = "speed")]
        pub speed: f64,
    }
}

fn main() {}
