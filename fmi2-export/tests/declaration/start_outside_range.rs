#[fmi2_export::interface]
mod variables {
    #[parameters]
    pub struct Parameters {
        /// Gain
        #[var(range = 0.0..=1.0, start = 0.5)]
        pub gain: f64,
        /// Damping
        #[var(range = 0.0..=1.0, start = 3.0)]
        pub damping: f64,
    }
}

fn main() {}
