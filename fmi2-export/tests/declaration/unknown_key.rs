#[fmi2_export::interface]
mod variables {
    #[parameters]
    pub struct Parameters {
        /// Gain
        #[var(range = 0.0..=1.0, minimum = 0.0)]
        pub gain: f64,
        /// Damping
        #[var(range = 0.0..1.0)]
        pub damping: f64,
        /// Mass
        #[var(start = 1.0, start = 2.0)]
        pub mass: f64,
    }
}

fn main() {}
